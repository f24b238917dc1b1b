// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "kissmap/formats/scan_log.hpp"

namespace kissmap {

/// How the bytes of a message are laid out.
enum class MessageEncoding : std::uint8_t { ros1, cdr, protobuf, other };

/// A named stream of messages of one type. Two publishers of one topic are one topic.
struct Topic {
  std::string name;
  std::string type;  ///< "sensor_msgs/PointCloud2": package and type, without the "msg" of ROS 2
  MessageEncoding encoding = MessageEncoding::other;
  std::optional<std::uint64_t> message_count;  ///< none where only reading to the end can tell
};

/// One recorded message; `data` is valid until the next call of next().
struct Message {
  std::size_t topic = 0;  ///< index among topics()
  std::int64_t received_ns = 0;
  std::span<const std::byte> data;
};

/// Damage that ends a container early: what came before it was delivered.
struct ContainerDamage {
  std::string reason;  ///< a text of refusal_reason
  std::string detail;  ///< file, place and cure
};

/// A container of recorded messages, read once from front to back in order of the times they were
/// received, where its index tells or its parts are in order. Memory is bounded by a few chunks.
/// Not thread safe.
class MessageSource {
 public:
  virtual ~MessageSource() = default;

  /// All topics where the container has an index; otherwise those found by looking through it.
  virtual const std::vector<Topic>& topics() const = 0;

  /// First and last receive time [ns since 1970], where the container tells without being read.
  virtual std::optional<std::pair<std::int64_t, std::int64_t>> time_range() const = 0;

  /// Times of receiving of a topic's messages in order, where an index tells them by reading no
  /// more than `most_bytes`. Before the first next().
  virtual std::optional<std::vector<std::int64_t>> times(std::size_t topic,
                                                         std::uint64_t most_bytes) = 0;

  /// Only messages of these topics come from next(). To be called before it.
  virtual void select(const std::set<std::size_t>& topics) = 0;

  /// False at the end, or where damage ends the container. Throws Error(input) for a container of
  /// which nothing more can be read for another cause than damage (the file went away).
  virtual bool next(Message& message) = 0;

  /// Passes over messages of the selected topics, without unpacking where the index allows.
  /// Returns how many there were to pass over, `count` or fewer.
  virtual std::uint64_t skip(std::uint64_t count) = 0;

  /// What was lost, known for sure after next() has returned false.
  virtual const std::vector<ContainerDamage>& damage() const = 0;

  virtual std::vector<LogFile> files() const = 0;

  /// Decisions the reader took, for the user: a missing index, another order than by name.
  virtual std::vector<std::string> notes() const = 0;
};

}  // namespace kissmap
