// SPDX-License-Identifier: MIT
#include "formats/containers/chunked_source.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace kissmap {
namespace {

/// So many chunks are held at once to put messages in order; a container whose chunks all claim
/// the same time would otherwise be read into memory as a whole.
constexpr std::size_t most_open_chunks = 8;

/// Whatever is read of a chunk's index costs the pages it lies in.
constexpr std::uint64_t index_pages_bytes = 8192;

}  // namespace

ContainerDamage damage_of(const Chunk& chunk, const ContainerFile& file, const Refusal& why) {
  return {
      why.reason(),
      file.path().string() + ": chunk at byte " + std::to_string(chunk.offset) + ": " + why.what()};
}

void sum_counts(ContainerIndex& index) {
  for (Topic& topic : index.topics) topic.message_count = 0;
  for (const Chunk& chunk : index.chunks) {
    for (const auto& [topic, count] : *chunk.counts) *index.topics[topic].message_count += count;
    auto& range = index.time_range;
    if (!range) range.emplace(chunk.first_ns, chunk.last_ns);
    range->first = std::min(range->first, chunk.first_ns);
    range->second = std::max(range->second, chunk.last_ns);
  }
}

ChunkedSource::ChunkedSource(std::shared_ptr<const ContainerFile> file,
                             ContainerIndex index,
                             std::unique_ptr<ChunkReader> reader)
    : file_(std::move(file)), index_(std::move(index)), reader_(std::move(reader)) {
  std::ranges::stable_sort(index_.chunks, {}, &Chunk::first_ns);
}

std::optional<std::vector<std::int64_t>> ChunkedSource::times(std::size_t topic,
                                                              std::uint64_t most_bytes) {
  std::vector<std::int64_t> times;
  for (const Chunk& chunk : index_.chunks) {
    if (chunk.counts && !chunk.counts->contains(topic)) continue;
    if (most_bytes < index_pages_bytes) return std::nullopt;
    most_bytes -= index_pages_bytes;
    if (!reader_->append_times(chunk, topic, times, most_bytes)) return std::nullopt;
  }
  std::ranges::stable_sort(times);
  return times;
}

std::optional<std::uint64_t> ChunkedSource::selected_in(Chunk& chunk) {
  if (!chunk.counts) reader_->count(chunk);
  if (!chunk.counts) return std::nullopt;
  std::uint64_t count = 0;
  for (const auto& [topic, messages] : *chunk.counts) {
    if (selected_.contains(topic)) count += messages;
  }
  return count;
}

bool ChunkedSource::open_next_chunk() {
  Chunk& chunk = index_.chunks[next_chunk_++];
  if (selected_in(chunk) == 0U) return false;
  Open opened;
  if (!spare_.empty()) {
    opened.chunk = std::move(spare_.back());
    spare_.pop_back();
  }
  opened.chunk.messages.clear();
  try {
    reader_->load(chunk, opened.chunk);
  } catch (const Refusal& refusal) {
    if (!chunk.damaged) index_.damage.push_back(damage_of(chunk, *file_, refusal));
  }
  std::erase_if(opened.chunk.messages,
                [&](const StoredMessage& m) { return !selected_.contains(m.topic); });
  if (opened.chunk.messages.empty()) {
    spare_.push_back(std::move(opened.chunk));
    return false;
  }
  std::ranges::stable_sort(opened.chunk.messages, {}, &StoredMessage::received_ns);
  open_.push_back(std::move(opened));
  return true;
}

void ChunkedSource::recycle_finished() {
  for (auto open = open_.begin(); open != open_.end();) {
    if (open->position < open->chunk.messages.size()) {
      ++open;
      continue;
    }
    spare_.push_back(std::move(open->chunk));
    open = open_.erase(open);
  }
}

ChunkedSource::Open* ChunkedSource::earliest() {
  recycle_finished();
  while (next_chunk_ < index_.chunks.size() && open_.size() < most_open_chunks) {
    const auto first = std::ranges::min_element(open_, {}, &Open::next_ns);
    if (first != open_.end() && first->next_ns() < index_.chunks[next_chunk_].first_ns) break;
    open_next_chunk();
  }
  const auto first = std::ranges::min_element(open_, {}, &Open::next_ns);
  return first == open_.end() ? nullptr : &*first;
}

bool ChunkedSource::next(Message& message) {
  Open* open = earliest();
  if (open == nullptr) return false;
  const StoredMessage& stored = open->chunk.messages[open->position++];
  message.topic = stored.topic;
  message.received_ns = stored.received_ns;
  message.data = std::span<const std::byte>(open->chunk.bytes).subspan(stored.offset, stored.size);
  return true;
}

bool ChunkedSource::stands_alone(std::size_t chunk) const {
  return chunk + 1 >= index_.chunks.size() ||
         index_.chunks[chunk].last_ns < index_.chunks[chunk + 1].first_ns;
}

std::uint64_t ChunkedSource::skip(std::uint64_t count) {
  std::uint64_t passed = 0;
  while (passed < count) {
    recycle_finished();
    if (open_.empty() && next_chunk_ < index_.chunks.size() && stands_alone(next_chunk_)) {
      const auto there = selected_in(index_.chunks[next_chunk_]);
      if (there && *there <= count - passed) {
        passed += *there;
        ++next_chunk_;
        continue;
      }
    }
    Open* open = earliest();
    if (open == nullptr) break;
    ++open->position;
    ++passed;
  }
  return passed;
}

}  // namespace kissmap
