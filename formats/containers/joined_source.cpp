// SPDX-License-Identifier: MIT
#include "formats/containers/joined_source.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace kissmap {
namespace {

std::int64_t first_time(const std::unique_ptr<MessageSource>& source) {
  const auto range = source->time_range();
  return range ? range->first : std::numeric_limits<std::int64_t>::max();
}

std::size_t place_of(const Topic& topic, std::vector<Topic>& topics) {
  const auto same = [&](const Topic& other) {
    return other.name == topic.name && other.type == topic.type && other.encoding == topic.encoding;
  };
  const auto found = std::ranges::find_if(topics, same);
  const auto place = static_cast<std::size_t>(found - topics.begin());
  if (found == topics.end()) {
    topics.push_back(topic);
  } else if (found->message_count && topic.message_count) {
    *found->message_count += *topic.message_count;
  } else {
    found->message_count.reset();
  }
  return place;
}

}  // namespace

JoinedSource::JoinedSource(std::vector<std::unique_ptr<MessageSource>> parts) {
  std::ranges::stable_sort(parts, {}, first_time);
  for (auto& source : parts) {
    Part part{std::move(source), {}};
    for (const Topic& topic : part.source->topics()) {
      part.topic_of.push_back(place_of(topic, topics_));
    }
    parts_.push_back(std::move(part));
  }
}

std::optional<std::pair<std::int64_t, std::int64_t>> JoinedSource::time_range() const {
  std::optional<std::pair<std::int64_t, std::int64_t>> range;
  for (const Part& part : parts_) {
    const auto more = part.source->time_range();
    if (!more) continue;
    if (!range) range = more;
    range->first = std::min(range->first, more->first);
    range->second = std::max(range->second, more->second);
  }
  return range;
}

std::optional<std::vector<std::int64_t>> JoinedSource::times(std::size_t topic,
                                                             std::uint64_t most_bytes) {
  std::vector<std::int64_t> times;
  for (Part& part : parts_) {
    const auto own = std::ranges::find(part.topic_of, topic);
    if (own == part.topic_of.end()) continue;
    const auto more = part.source->times(static_cast<std::size_t>(own - part.topic_of.begin()),
                                         most_bytes / parts_.size());
    if (!more) return std::nullopt;
    times.insert(times.end(), more->begin(), more->end());
  }
  std::ranges::stable_sort(times);
  return times;
}

void JoinedSource::select(const std::set<std::size_t>& topics) {
  for (Part& part : parts_) {
    std::set<std::size_t> own;
    for (std::size_t i = 0; i < part.topic_of.size(); ++i) {
      if (topics.contains(part.topic_of[i])) own.insert(i);
    }
    part.source->select(own);
  }
}

void JoinedSource::leave_part() {
  const auto& damage = parts_[current_++].source->damage();
  damage_.insert(damage_.end(), damage.begin(), damage.end());
}

bool JoinedSource::next(Message& message) {
  while (current_ < parts_.size()) {
    if (parts_[current_].source->next(message)) {
      message.topic = parts_[current_].topic_of[message.topic];
      return true;
    }
    leave_part();
  }
  return false;
}

std::uint64_t JoinedSource::skip(std::uint64_t count) {
  std::uint64_t passed = 0;
  while (current_ < parts_.size()) {
    passed += parts_[current_].source->skip(count - passed);
    if (passed == count) break;
    leave_part();
  }
  return passed;
}

std::vector<LogFile> JoinedSource::files() const {
  std::vector<LogFile> files;
  for (const Part& part : parts_)
    std::ranges::move(part.source->files(), std::back_inserter(files));
  return files;
}

std::vector<std::string> JoinedSource::notes() const {
  std::vector<std::string> notes;
  for (const Part& part : parts_)
    std::ranges::move(part.source->notes(), std::back_inserter(notes));
  return notes;
}

void JoinedSource::set_counts(const std::map<std::string, std::uint64_t>& counts) {
  for (Topic& topic : topics_) {
    const auto found = counts.find(topic.name);
    if (found != counts.end()) topic.message_count = found->second;
  }
}

}  // namespace kissmap
