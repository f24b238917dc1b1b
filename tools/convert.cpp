// SPDX-License-Identifier: MIT
#include <cstdio>

#include "commands.hpp"
#include "kissmap/error.hpp"
#include "kissmap/formats/registry.hpp"
#include "kissmap/formats/scan_writer.hpp"
#include "kissmap/formats/session.hpp"
#include "paths.hpp"
#include "progress.hpp"
#include "report.hpp"

namespace kissmap {
namespace {

void count_refusal(const LogEntry& entry, SessionCounts& counts) {
  const auto& refused = std::get<RefusedScan>(entry.content);
  Refusals& refusals = counts.scans_refused[refused.reason];
  if (++refusals.count <= max_refusal_examples) refusals.examples.push_back(entry.name);
}

void write_scans(ScanLog& log, ScanWriter& writer, SessionCounts& counts, ProgressLine& line) {
  while (const auto entry = log.next()) {
    ++counts.scans_read;
    if (std::holds_alternative<RefusedScan>(entry->content)) {
      count_refusal(*entry, counts);
      continue;
    }
    const auto& scan = std::get<Scan>(entry->content);
    writer.add(scan);
    ++counts.scans_used;
    counts.points_read += scan.points.size();
    counts.points_dropped += scan.dropped;
    line.show(with_commas(counts.scans_used) + " scans");
  }
}

}  // namespace

void convert(const ConvertCommand& command) {
  const ScanFormat format = scan_format_named(command.to);
  require_outside(command.output, command.log, "the log");
  require_valid(command.selection);
  const auto log = read_ahead(
      select_scans(open_log(command.log, command.options, command.format), command.selection));
  const auto writer = open_scan_writer(command.output, format);
  SessionCounts counts;
  {
    ProgressLine line(!command.quiet);
    write_scans(*log, *writer, counts, line);
  }
  if (counts.scans_used == 0) throw input_error(command.log, "holds no scan that can be read");
  writer->finish();
  if (command.quiet) return;
  std::printf("%s\n  scans       %s, %s points\n",
              printable(command.output.string()).c_str(),
              with_commas(counts.scans_used).c_str(),
              with_commas(counts.points_read).c_str());
  std::fputs(describe_refusals(counts).c_str(), stdout);
}

}  // namespace kissmap
