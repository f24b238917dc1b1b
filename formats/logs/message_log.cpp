// SPDX-License-Identifier: MIT
#include "formats/logs/message_log.hpp"

#include <algorithm>
#include <deque>
#include <utility>

#include "formats/clouds/refusal.hpp"
#include "formats/logs/pass_over.hpp"
#include "formats/logs/sweep_maker.hpp"
#include "kissmap/error.hpp"

namespace kissmap {
namespace {

constexpr std::uint64_t most_index_bytes = 48 << 20;

std::string described(const Topic& topic) {
  std::string text = "\n  " + topic.name + "  (" + topic.type;
  if (topic.message_count) text += ", " + std::to_string(*topic.message_count) + " messages";
  return text + ")";
}

std::string listed(const std::vector<Topic>& topics) {
  std::string text;
  for (const Topic& topic : topics) text += described(topic);
  return text.empty() ? " none" : text;
}

bool is_candidate(const Topic& topic) {
  return holds_scans(topic) && topic.message_count != 0U;
}

std::size_t named_topic(const std::vector<Topic>& topics,
                        const std::string& name,
                        const std::filesystem::path& path) {
  const auto fits = [&](const Topic& topic) { return topic.name == name && holds_scans(topic); };
  auto found = std::ranges::find_if(topics, fits);
  if (found != topics.end()) return static_cast<std::size_t>(found - topics.begin());
  const bool there = std::ranges::find(topics, name, &Topic::name) != topics.end();
  throw usage_error("--topic " + name + ": " +
                    (there ? "kissmap reads no scans from messages of its type; "
                           : "is not in " + path.string() + "; ") +
                    "topics:" + listed(topics));
}

// Damage met while the container was opened may be why nothing was found in it.
std::string listed(const std::vector<ContainerDamage>& damages) {
  std::string text;
  for (const ContainerDamage& damage : damages) text += "\n  " + damage.detail;
  return text;
}

std::size_t the_topic(const MessageSource& source,
                      const std::string& name,
                      const std::filesystem::path& path) {
  const std::vector<Topic>& topics = source.topics();
  if (!name.empty()) return named_topic(topics, name, path);
  std::vector<Topic> candidates;
  std::ranges::copy_if(topics, std::back_inserter(candidates), is_candidate);
  if (candidates.size() > 1) {
    throw input_error(path,
                      "several topics hold scans; choose one with --topic:" + listed(candidates));
  }
  if (candidates.empty()) {
    throw input_error(path,
                      "no topic holds scans kissmap can read; topics:" + listed(topics) +
                          listed(source.damage()));
  }
  const auto found = std::ranges::find_if(topics, is_candidate);
  return static_cast<std::size_t>(found - topics.begin());
}

class MessageLog : public ScanLog {
 public:
  MessageLog(std::unique_ptr<MessageSource> source,
             std::size_t topic,
             LogInfo info,
             const ReadOptions& options)
      : source_(std::move(source)),
        topic_(source_->topics()[topic].name),
        maker_(make_sweep_maker(source_->topics()[topic], options)),
        info_(std::move(info)) {
    std::set<std::size_t> wanted{topic};
    for (std::size_t i = 0; i < source_->topics().size(); ++i) {
      if (maker_->wants(source_->topics()[i])) wanted.insert(i);
    }
    source_->select(wanted);
    const auto& count = source_->topics()[topic].message_count;
    if (count && maker_->one_scan_a_message()) info_.scan_count = *count;
    info_.stamp_source = "messages";
    info_.notes = source_->notes();
    info_.notes.push_back("scans from topic " + topic_ + " (" + source_->topics()[topic].type +
                          ")");
    peeked_ = read();
    for (std::string& note : maker_->notes()) info_.notes.push_back(std::move(note));
    info_.sensor = maker_->sensor();
    info_.fields = maker_->fields();
    info_.time_range = source_->time_range();
    for (const Topic& other : source_->topics()) {
      info_.topics.push_back({other.name, other.type, other.message_count});
    }
  }

  const LogInfo& info() const override { return info_; }
  std::vector<LogFile> files() const override {
    std::vector<LogFile> files = maker_->side_files();
    std::ranges::move(source_->files(), std::back_inserter(files));
    return files;
  }

  std::optional<LogEntry> next() override {
    std::optional<LogEntry> entry = peeked_ ? std::exchange(peeked_, std::nullopt) : read();
    if (entry) entry->index = next_index_++;
    return entry;
  }

  std::optional<std::vector<std::int64_t>> known_times() override {
    if (!maker_->one_scan_a_message()) return std::nullopt;
    const auto& topics = source_->topics();
    const auto own = std::ranges::find(topics, topic_, &Topic::name);
    return source_->times(static_cast<std::size_t>(own - topics.begin()), most_index_bytes);
  }

  void skip(std::size_t count) override {
    if (!maker_->one_scan_a_message()) return pass_over(count, *maker_, *this);
    if (count > 0 && peeked_) {
      peeked_.reset();
      --count;
      ++next_index_;
    }
    const std::uint64_t passed = source_->skip(count);
    messages_ += passed;
    next_index_ += passed;
  }

 private:
  // The message read last, counted from 0.
  std::string name_of_message() const { return topic_ + "[" + std::to_string(messages_ - 1) + "]"; }

  std::optional<LogEntry> read() {
    while (true) {
      if (auto scan = maker_->take()) return LogEntry{0, name_of_message(), std::move(*scan)};
      Message message;
      if (at_end_) return read_damage();
      try {
        if (!source_->next(message)) {
          at_end_ = true;
          maker_->finish();
          continue;
        }
        ++messages_;
        maker_->add(message, source_->topics()[message.topic]);
      } catch (const Refusal& refusal) {
        return LogEntry{
            0,
            name_of_message(),
            RefusedScan{refusal.reason(),
                        info_.path.string() + ": " + name_of_message() + ": " + refusal.what()}};
      }
    }
  }

  std::optional<LogEntry> read_damage() {
    if (damage_read_ >= source_->damage().size()) return std::nullopt;
    const ContainerDamage& damage = source_->damage()[damage_read_++];
    return LogEntry{0, info_.path.filename().string(), RefusedScan{damage.reason, damage.detail}};
  }

  std::unique_ptr<MessageSource> source_;
  std::string topic_;
  std::unique_ptr<SweepMaker> maker_;
  LogInfo info_;
  std::optional<LogEntry> peeked_;
  std::size_t next_index_ = 0;
  std::uint64_t messages_ = 0;
  std::size_t damage_read_ = 0;
  bool at_end_ = false;
};

}  // namespace

std::unique_ptr<ScanLog> open_message_log(std::unique_ptr<MessageSource> source,
                                          LogInfo info,
                                          const ReadOptions& options) {
  const std::size_t topic = the_topic(*source, options.topic, info.path);
  return std::make_unique<MessageLog>(std::move(source), topic, std::move(info), options);
}

}  // namespace kissmap
