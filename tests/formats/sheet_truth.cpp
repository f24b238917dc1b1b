// SPDX-License-Identifier: MIT
#include "formats/sheet_truth.hpp"

#include <sstream>

namespace kissmap::test {
namespace {

double number_or_none(const std::string& word, std::vector<double>& column) {
  if (word == "-") return 0.0;
  column.push_back(std::stod(word));
  return column.back();
}

ExpectedScan read_scan(std::istream& in, const std::string& first_words) {
  std::istringstream words(first_words);
  std::string kind;
  std::size_t count = 0;
  ExpectedScan scan;
  words >> kind >> scan.stamp_ns >> scan.instants >> scan.compensations >> scan.time_sources >>
      scan.dropped.zero >> scan.dropped.non_finite >> count;
  if (!words) throw std::runtime_error("truth.txt: " + first_words);
  scan.whole_log = kind == "stream";
  for (std::size_t i = 0; i < count; ++i) {
    Eigen::Vector3d point;
    std::string intensity, time;
    in >> point.x() >> point.y() >> point.z() >> intensity >> time;
    scan.points.push_back(point);
    number_or_none(intensity, scan.intensities);
    number_or_none(time, scan.times);
  }
  if (!in) throw std::runtime_error("truth.txt: cut");
  in >> std::ws;
  return scan;
}

bool is_one_of(const std::string& words, const std::string& word) {
  return words == "-" || ("|" + words + "|").find("|" + word + "|") != std::string::npos;
}

std::string word_of(StampInstant instant) {
  constexpr const char* words[] = {"unknown", "start", "middle", "end"};
  return words[static_cast<int>(instant)];
}

std::string word_of(Compensation compensation) {
  constexpr const char* words[] = {"unknown", "no", "yes"};
  return words[static_cast<int>(compensation)];
}

std::string word_of(TimeSource source) {
  constexpr const char* words[] = {"none", "recorded", "derived"};
  return words[static_cast<int>(source)];
}

void expect_words(const ExpectedScan& expected, const Scan& scan) {
  EXPECT_TRUE(is_one_of(expected.instants, word_of(scan.stamp_instant)))
      << word_of(scan.stamp_instant);
  EXPECT_TRUE(is_one_of(expected.compensations, word_of(scan.compensation)))
      << word_of(scan.compensation);
  EXPECT_TRUE(is_one_of(expected.time_sources, word_of(scan.time_source)))
      << word_of(scan.time_source);
}

/// Appends a scan to what was seen; its times become relative to `stamp_ns`.
void append(ExpectedScan& seen, const Scan& scan) {
  for (const auto& point : scan.points) seen.points.push_back(point.cast<double>());
  seen.intensities.insert(seen.intensities.end(), scan.intensities.begin(), scan.intensities.end());
  const double shift = static_cast<double>(scan.stamp_ns - seen.stamp_ns) * 1e-9;
  for (const float offset : scan.time_offsets)
    seen.times.push_back(shift + static_cast<double>(offset));
  seen.dropped += scan.dropped;
}

void expect_whole_log(const ExpectedLog& expected, ScanLog& log, const Resolution& resolution) {
  const ExpectedScan& whole = expected.scans[0];
  ExpectedScan seen;
  seen.stamp_ns = whole.stamp_ns;
  std::size_t sweeps = 0;
  std::size_t refused = 0;
  for (const LogEntry& entry : read_all(log)) {
    if (std::holds_alternative<RefusedScan>(entry.content)) {
      ++refused;
      continue;
    }
    expect_words(whole, scan_of(entry));
    append(seen, scan_of(entry));
    ++sweeps;
  }
  EXPECT_GT(sweeps, 1U);
  EXPECT_EQ(refused, expected.scans.size() - 1);
  expect_points(whole, seen, resolution);
}

void expect_scan(const ExpectedScan& expected,
                 const LogEntry& entry,
                 const Resolution& resolution) {
  if (expected.refused) {
    EXPECT_TRUE(std::holds_alternative<RefusedScan>(entry.content));
    return;
  }
  const Scan& scan = scan_of(entry);
  EXPECT_EQ(scan.stamp_ns, expected.stamp_ns);
  expect_words(expected, scan);
  EXPECT_EQ(scan.dropped, expected.dropped);
  ExpectedScan seen;
  seen.stamp_ns = scan.stamp_ns;
  append(seen, scan);
  if (expected.times.empty()) seen.times.clear();  // the words have said what may be there
  expect_points(expected, seen, resolution);
}

}  // namespace

std::vector<ExpectedLog> read_truth(const std::filesystem::path& folder) {
  std::ifstream in(folder / "truth.txt");
  std::vector<ExpectedLog> logs;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("log ")) {
      std::istringstream words(line);
      std::string log, path;
      ExpectedLog& next = logs.emplace_back();
      words >> log >> path >> next.format >> next.topic;
      next.path = (folder / path).lexically_normal();
    } else if (line == "refused") {
      logs.at(logs.size() - 1).scans.emplace_back().refused = true;
    } else {
      logs.at(logs.size() - 1).scans.push_back(read_scan(in, line));
    }
  }
  if (logs.empty()) throw std::runtime_error(folder.string() + ": no truth.txt");
  return logs;
}

void expect_points(const ExpectedScan& expected,
                   const ExpectedScan& seen,
                   const Resolution& resolution) {
  ASSERT_EQ(seen.points.size(), expected.points.size());
  ASSERT_EQ(seen.intensities.size(), expected.intensities.size());
  ASSERT_EQ(seen.times.size(), expected.times.size());
  for (std::size_t i = 0; i < expected.points.size(); ++i) {
    if (resolution.point == 0.0) {
      ASSERT_EQ(seen.points[i].cast<float>(), expected.points[i].cast<float>()) << i;
    } else {
      ASSERT_LE((seen.points[i] - expected.points[i]).norm(), resolution.point) << i;
    }
  }
  for (std::size_t i = 0; i < expected.intensities.size(); ++i) {
    ASSERT_FLOAT_EQ(static_cast<float>(seen.intensities[i]),
                    static_cast<float>(expected.intensities[i]))
        << i;
  }
  for (std::size_t i = 0; i < expected.times.size(); ++i) {
    ASSERT_NEAR(seen.times[i], expected.times[i], resolution.time) << i;
  }
}

void expect_log(const ExpectedLog& expected, const Resolution& resolution) {
  SCOPED_TRACE(expected.path.string() + " " + expected.topic);
  ASSERT_FALSE(expected.scans.empty());
  ReadOptions options;
  options.topic = expected.topic;
  const auto log = open_log(expected.path, options);
  EXPECT_EQ(log->info().format, expected.format);
  if (expected.scans[0].whole_log) return expect_whole_log(expected, *log, resolution);
  const std::vector<LogEntry> entries = read_all(*log);
  ASSERT_EQ(entries.size(), expected.scans.size());
  for (std::size_t i = 0; i < entries.size(); ++i) {
    SCOPED_TRACE("scan " + std::to_string(i));
    expect_scan(expected.scans[i], entries[i], resolution);
  }
}

void run_generator(const std::string& arguments) {
  run(std::string(KISSMAP_TEST_PYTHON) + " -B " KISSMAP_TEST_SOURCES "/generators/" + arguments);
}

Generated::Generated(const std::string& script) {
  run_generator(script + " " + dir_.path().string());
  logs_ = read_truth(dir_.path());
}

}  // namespace kissmap::test
