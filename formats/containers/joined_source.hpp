// SPDX-License-Identifier: MIT
#pragma once

#include <map>
#include <memory>
#include <string>

#include "formats/containers/message_source.hpp"

namespace kissmap {

/// The files of a split recording, one behind the other in the order of their first messages,
/// whatever their names say.
class JoinedSource : public MessageSource {
 public:
  explicit JoinedSource(std::vector<std::unique_ptr<MessageSource>> parts);

  const std::vector<Topic>& topics() const override { return topics_; }
  std::optional<std::pair<std::int64_t, std::int64_t>> time_range() const override;
  std::optional<std::vector<std::int64_t>> times(std::size_t topic,
                                                 std::uint64_t most_bytes) override;
  void select(const std::set<std::size_t>& topics) override;
  bool next(Message& message) override;
  std::uint64_t skip(std::uint64_t count) override;
  const std::vector<ContainerDamage>& damage() const override { return damage_; }
  std::vector<LogFile> files() const override;
  std::vector<std::string> notes() const override;

  /// Counts of messages by topic, from where they are written down beside the files.
  void set_counts(const std::map<std::string, std::uint64_t>& counts);

 private:
  struct Part {
    std::unique_ptr<MessageSource> source;
    std::vector<std::size_t> topic_of;  ///< ours, by the part's
  };
  void leave_part();

  std::vector<Part> parts_;
  std::vector<Topic> topics_;
  std::vector<ContainerDamage> damage_;
  std::size_t current_ = 0;
};

}  // namespace kissmap
