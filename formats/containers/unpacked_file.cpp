// SPDX-License-Identifier: MIT
#include "formats/containers/unpacked_file.hpp"

#include <zstd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <system_error>
#include <utility>

#include "formats/clouds/refusal.hpp"
#include "formats/containers/container_file.hpp"
#include "kissmap/error.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t step_bytes = 1 << 20;

/// A folder of our own that goes with everything in it.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::error_code error;
    std::string pattern = (fs::temp_directory_path(error) / "kissmap-XXXXXX").string();
    if (error || ::mkdtemp(pattern.data()) == nullptr) {
      throw output_error(pattern, "no folder for temporary files can be made there; set TMPDIR");
    }
    path_ = pattern;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

[[noreturn]] void no_room(const fs::path& to) {
  throw output_error(to,
                     "cannot be written: " + std::generic_category().message(errno) +
                         "; the bag's packed file is unpacked there, set TMPDIR to a folder with "
                         "room");
}

void write_all(std::FILE* file, const std::vector<char>& bytes, std::size_t n, const fs::path& to) {
  if (std::fwrite(bytes.data(), 1, n, file) != n) no_room(to);
}

/// Returns what was wrong with the stream, if anything.
std::optional<ContainerDamage> unpack_to(const fs::path& packed, const fs::path& to) {
  const ContainerFile in(packed);
  const std::unique_ptr<std::FILE, CloseFile> out(std::fopen(to.c_str(), "wb"));
  if (!out) throw output_error(to, "cannot be written: " + std::generic_category().message(errno));
  const std::unique_ptr<ZSTD_DCtx, std::size_t (*)(ZSTD_DCtx*)> context(ZSTD_createDCtx(),
                                                                        ZSTD_freeDCtx);
  std::vector<std::byte> buffer;
  std::vector<char> room(step_bytes);
  std::size_t hint = 1;
  for (std::uint64_t offset = 0; offset < in.size(); offset += step_bytes) {
    const auto bytes = in.read(offset, step_bytes, buffer);
    ZSTD_inBuffer from{bytes.data(), bytes.size(), 0};
    while (from.pos < from.size) {
      ZSTD_outBuffer space{room.data(), room.size(), 0};
      hint = ZSTD_decompressStream(context.get(), &space, &from);
      write_all(out.get(), room, space.pos, to);
      if (ZSTD_isError(hint) != 0U) {
        return ContainerDamage{refusal_reason::broken_content,
                               packed.string() + ": zstd data broken: " + ZSTD_getErrorName(hint)};
      }
    }
  }
  // What the decoder still holds back.
  for (bool more = hint != 0; more;) {
    ZSTD_inBuffer nothing{nullptr, 0, 0};
    ZSTD_outBuffer space{room.data(), room.size(), 0};
    hint = ZSTD_decompressStream(context.get(), &space, &nothing);
    write_all(out.get(), room, space.pos, to);
    more = ZSTD_isError(hint) == 0U && space.pos == room.size();
  }
  if (std::fflush(out.get()) != 0) no_room(to);
  if (hint == 0) return std::nullopt;
  return ContainerDamage{refusal_reason::truncated,
                         packed.string() + ": the zstd stream ends early; copy the file anew"};
}

class UnpackedSource : public MessageSource {
 public:
  UnpackedSource(const fs::path& packed,
                 const std::function<std::unique_ptr<MessageSource>(const fs::path&)>& open)
      : packed_(packed), unpacked_(folder_.path() / packed.stem()) {
    if (auto damage = unpack_to(packed, unpacked_)) damage_.push_back(std::move(*damage));
    try {
      source_ = open(unpacked_);
    } catch (const Error& error) {
      throw Error(error.fault(), damage_.empty() ? by_its_name(error.what()) : damage_[0].detail);
    }
  }

  const std::vector<Topic>& topics() const override { return source_->topics(); }
  std::optional<std::pair<std::int64_t, std::int64_t>> time_range() const override {
    return source_->time_range();
  }
  std::optional<std::vector<std::int64_t>> times(std::size_t topic,
                                                 std::uint64_t most_bytes) override {
    return source_->times(topic, most_bytes);
  }
  void select(const std::set<std::size_t>& topics) override { source_->select(topics); }
  bool next(Message& message) override { return source_->next(message); }
  std::uint64_t skip(std::uint64_t count) override { return source_->skip(count); }
  // Damage of the stream explains that of the file unpacked from it.
  const std::vector<ContainerDamage>& damage() const override {
    if (!damage_.empty()) return damage_;
    while (damage_inside_.size() < source_->damage().size()) {
      const ContainerDamage& damage = source_->damage()[damage_inside_.size()];
      damage_inside_.push_back({damage.reason, by_its_name(damage.detail)});
    }
    return damage_inside_;
  }
  std::vector<LogFile> files() const override { return {ContainerFile(packed_).log_file()}; }
  std::vector<std::string> notes() const override { return source_->notes(); }

 private:
  // The temporary file is gone when its name is read.
  std::string by_its_name(std::string text) const {
    const std::size_t at = text.find(unpacked_.string());
    return at == std::string::npos ? text
                                   : text.replace(at, unpacked_.string().size(), packed_.string());
  }

  fs::path packed_;
  TemporaryFolder folder_;
  fs::path unpacked_;
  std::vector<ContainerDamage> damage_;                 // of the stream
  mutable std::vector<ContainerDamage> damage_inside_;  // of the file in it
  std::unique_ptr<MessageSource> source_;
};

}  // namespace

std::unique_ptr<MessageSource> open_unpacked(
    const fs::path& packed,
    const std::function<std::unique_ptr<MessageSource>(const fs::path&)>& open) {
  return std::make_unique<UnpackedSource>(packed, open);
}

}  // namespace kissmap
