// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstdio>

#include "commands.hpp"
#include "info_closures.hpp"
#include "info_sample.hpp"
#include "kissmap/error.hpp"
#include "kissmap/formats/georeference.hpp"
#include "kissmap/formats/pack.hpp"
#include "kissmap/formats/registry.hpp"
#include "kissmap/formats/session.hpp"
#include "report.hpp"

namespace kissmap {
namespace {

const char* to_string(StampInstant instant) {
  switch (instant) {
    case StampInstant::sweep_start:
      return "the start of a sweep";
    case StampInstant::sweep_middle:
      return "the middle of a sweep";
    case StampInstant::sweep_end:
      return "the end of a sweep";
    case StampInstant::unknown:
      break;
  }
  return "an unknown instant of a sweep";
}

const char* to_string(Compensation compensation) {
  switch (compensation) {
    case Compensation::yes:
      return "already compensated for motion";
    case Compensation::no:
      return "not compensated for motion";
    case Compensation::unknown:
      break;
  }
  return "not known to be compensated for motion";
}

void print_scan(const LogEntry& entry) {
  if (const auto* refused = std::get_if<RefusedScan>(&entry.content)) {
    std::printf(
        "  %s: %s: %s\n", entry.name.c_str(), refused->reason.c_str(), refused->detail.c_str());
    return;
  }
  const auto& scan = std::get<Scan>(entry.content);
  std::printf("  first scan  %s: %s returns, %s left out\n",
              printable(entry.name).c_str(),
              with_commas(scan.points.size()).c_str(),
              with_commas(scan.dropped.total()).c_str());
  std::printf("  points      %s intensity, %s\n",
              scan.intensities.empty() ? "no" : "with",
              to_string(scan.compensation));
  if (const auto span = time_span(scan)) {
    std::printf("  times       %.6f..%.6f s from the stamp, %s\n",
                static_cast<double>(span->first),
                static_cast<double>(span->last),
                scan.time_source == TimeSource::recorded ? "recorded" : "derived");
  } else {
    std::printf("  times       none inside a scan\n");
  }
  std::printf("  stamp       denotes %s\n", to_string(scan.stamp_instant));
}

/// Reads the rest of a log and tells what is in it.
void print_whole(ScanLog& log, LogEntry entry) {
  SessionCounts counts;
  StampGaps gaps;
  std::optional<std::int64_t> first;
  std::int64_t last = 0;
  std::size_t used = 0;
  for (std::optional<LogEntry> next = std::move(entry); next; next = log.next()) {
    ++counts.scans_read;
    if (const auto* refused = std::get_if<RefusedScan>(&next->content)) {
      Refusals& refusals = counts.scans_refused[refused->reason];
      if (++refusals.count <= max_refusal_examples) refusals.examples.push_back(next->name);
      continue;
    }
    const auto& scan = std::get<Scan>(next->content);
    counts.points_read += scan.points.size();
    counts.points_dropped += scan.dropped;
    if (first && scan.stamp_ns <= last) {
      ++counts.scans_refused["stamp not after that of the scan before"].count;
      continue;
    }
    gaps.observe(next->index, scan.stamp_ns);
    ++used;
    first = first.value_or(scan.stamp_ns);
    last = scan.stamp_ns;
  }
  counts.gaps = gaps.gaps();
  const double seconds = first ? 1e-9 * static_cast<double>(last - *first) : 0.0;
  std::printf("  whole log   %s scans, %s returns, %.3f s%s\n",
              with_commas(counts.scans_read).c_str(),
              with_commas(counts.points_read).c_str(),
              seconds,
              describe_rate(used, seconds).c_str());
  if (used > 0) {
    std::printf("  per scan    %s returns\n", with_commas(counts.points_read / used).c_str());
  }
  std::fputs(describe_refusals(counts).c_str(), stdout);
}

using Times = std::optional<std::vector<std::int64_t>>;  // [ns]

/// By the index of the log, or what else tells before it is read; true if that tells the rate.
bool print_duration(const LogInfo& about, const Times& times) {
  auto range = about.time_range;
  if (!range && times && !times->empty()) {
    const auto [first, last] = std::ranges::minmax(*times);
    range.emplace(first, last);
  }
  if (!range) return false;
  const double seconds =
      1e-9 * (static_cast<double>(range->second) - static_cast<double>(range->first));
  const std::string rate = describe_rate(about.scan_count.value_or(0), seconds);
  std::printf("  duration    %.3f s%s\n", seconds, rate.c_str());
  return !rate.empty();
}

void print_gaps(const std::vector<std::int64_t>& times_ns) {
  StampGaps gaps;
  std::optional<std::int64_t> last;
  for (std::size_t i = 0; i < times_ns.size(); ++i) {
    if (last && times_ns[i] <= *last) continue;
    gaps.observe(i, times_ns[i]);
    last = times_ns[i];
  }
  SessionCounts counts;
  counts.gaps = gaps.gaps();
  if (counts.gaps.empty()) std::printf("  gaps        none\n");
  std::fputs(describe_refusals(counts).c_str(), stdout);
}

void print_topics(const LogInfo& about) {
  for (const LogTopic& topic : about.topics) {
    std::printf(
        "  topic       %s (%s", printable(topic.name).c_str(), printable(topic.type).c_str());
    if (topic.message_count)
      std::printf(", %s messages", with_commas(*topic.message_count).c_str());
    std::printf(")\n");
  }
}

void print_log(const InfoCommand& command) {
  std::unique_ptr<ScanLog> log = open_log(command.path, command.options, command.format);
  if (command.all) log = read_ahead(std::move(log));
  const LogInfo& about = log->info();
  std::printf("%s\n  format      %s\n", about.path.c_str(), about.format.c_str());
  if (!about.sensor.empty()) std::printf("  sensor      %s\n", printable(about.sensor).c_str());
  if (about.scan_count) std::printf("  scans       %s\n", with_commas(*about.scan_count).c_str());
  const Times times = log->known_times();
  const bool rate_is_known = print_duration(about, times);
  std::printf("  stamps      from %s\n", about.stamp_source.c_str());
  if (times && !command.all) print_gaps(*times);
  if (!times && !command.all) std::printf("  gaps        not known before it is read (--all)\n");
  std::optional<LogEntry> entry = log->next();
  if (!entry) throw input_error(about.path, "holds no scan");
  print_scan(*entry);
  if (!command.all && !rate_is_known) std::fputs(describe_sample(*log, *entry).c_str(), stdout);
  if (!about.fields.empty()) std::printf("  fields      %s\n", printable(about.fields).c_str());
  print_topics(about);
  for (const std::string& place : find_georeference(about, entry->name)) {
    std::printf("  georeference %s\n", printable(place).c_str());
  }
  for (const std::string& note : about.notes) std::printf("  note        %s\n", note.c_str());
  if (command.all) print_whole(*log, std::move(*entry));
}

void require_pack(const std::filesystem::path& session, const PackSummary& pack) {
  const std::filesystem::path file = session / pack_file_name;
  std::error_code missing;
  if (std::filesystem::file_size(file, missing) == pack.bytes && !missing) return;
  throw input_error(file, "is missing or not as it was written; make it again with 'kissmap pack'");
}

void print_session(const std::filesystem::path& path, bool all_closures) {
  constexpr std::size_t most = 20;  // lines
  const Session session = read_session(path);
  require_local_maps(session);
  const SessionManifest& manifest = session.manifest;
  std::printf("%s\n  session     format %d, made by kissmap %s\n",
              path.c_str(),
              manifest.format_version,
              manifest.program_version.c_str());
  std::printf("  log         %s (%s, %zu files, stamps from %s)\n",
              manifest.log.path.c_str(),
              manifest.log.format.c_str(),
              manifest.log.files.size(),
              manifest.log.stamp_source.c_str());
  std::printf("  scans       %s used of %s\n",
              with_commas(manifest.counts.scans_used).c_str(),
              with_commas(manifest.counts.scans_read).c_str());
  std::printf("  points      %s returns\n", with_commas(manifest.counts.points_read).c_str());
  std::printf("  path        %.1f m in %zu local map%s\n",
              manifest.path_length,
              session.local_maps.size(),
              session.local_maps.size() == 1 ? "" : "s");
  std::fputs(describe_closures(session, all_closures ? session.closures.size() : most).c_str(),
             stdout);
  if (manifest.pack) require_pack(path, *manifest.pack);
  std::printf("  pack        %s\n", manifest.pack ? describe(*manifest.pack).c_str() : "none");
  std::fputs(describe_refusals(manifest.counts).c_str(), stdout);
}

}  // namespace

void info(const InfoCommand& command) {
  if (is_session(command.path) && command.format.empty()) {
    print_session(command.path, command.all);
  } else {
    print_log(command);
  }
}

}  // namespace kissmap
