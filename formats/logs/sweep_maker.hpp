// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>

#include "formats/containers/message_source.hpp"
#include "kissmap/formats/scan_log.hpp"

namespace kissmap {

/// Turns the messages of one topic into scans. Not thread safe.
class SweepMaker {
 public:
  virtual ~SweepMaker() = default;

  /// A message of the topic the maker was made for, or of one it also `wants`. Throws Refusal for
  /// a message that holds no scan.
  virtual void add(const Message& message, const Topic& topic) = 0;
  /// Topics that tell about the sensor.
  virtual bool wants(const Topic&) const { return false; }
  /// The oldest scan that is complete.
  virtual std::optional<Scan> take() = 0;
  /// Of the next scans, so many are not wanted; they may come with some of their points left out.
  /// Replaces what was said before: see PacketDecoder::pass.
  virtual void pass(std::size_t) {}
  /// No more messages come. Throws Refusal where nothing could be made of them.
  virtual void finish() {}
  /// Each message is a scan: passing over messages is passing over scans.
  virtual bool one_scan_a_message() const = 0;
  /// What was decided so far, for the user.
  virtual std::vector<std::string> notes() const = 0;
  /// The sensor, where the messages tell it, and the fields of a point, once a scan was made.
  virtual std::string sensor() const { return ""; }
  virtual std::string fields() const { return ""; }
  /// Files read besides the messages.
  virtual std::vector<LogFile> side_files() const { return {}; }
};

/// True for topics make_sweep_maker knows what to do with.
bool holds_scans(const Topic& topic);
std::unique_ptr<SweepMaker> make_sweep_maker(const Topic& topic, const ReadOptions& options);

}  // namespace kissmap
