// SPDX-License-Identifier: MIT
#include "kissmap/formats/surfel_spool.hpp"

#include <fcntl.h>
#include <stdlib.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <string>
#include <system_error>

#include "kissmap/error.hpp"

namespace kissmap {
namespace {

using Record = std::array<float, 6>;  // mean, normal

constexpr std::size_t record_size = sizeof(Record);

std::vector<Record> records_of(const SurfelCloud& surfels) {
  std::vector<Record> records;
  records.reserve(surfels.size());
  for (std::size_t i = 0; i < surfels.size(); ++i) {
    const Eigen::Vector3f& m = surfels.means[i];
    const Eigen::Vector3f& n = surfels.normals[i];
    records.push_back({m.x(), m.y(), m.z(), n.x(), n.y(), n.z()});
  }
  return records;
}

}  // namespace

SurfelSpool::SurfelSpool(const std::filesystem::path& folder) : folder_(folder) {
  std::string name = (folder / "surfels-XXXXXX").string();
  descriptor_ = ::mkostemp(name.data(), O_CLOEXEC);
  if (descriptor_ < 0 || ::unlink(name.c_str()) != 0) {
    throw output_error(folder, "cannot be written to: " + std::generic_category().message(errno));
  }
}

SurfelSpool::~SurfelSpool() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void SurfelSpool::add(const SurfelCloud& surfels) {
  const std::vector<Record> records = records_of(surfels);
  const auto* bytes = reinterpret_cast<const char*>(records.data());
  std::size_t left = records.size() * record_size;
  auto at = static_cast<off_t>(begins_.back() * record_size);
  while (left > 0) {
    const ssize_t written = ::pwrite(descriptor_, bytes, left, at);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) {
      throw output_error(
          folder_,
          std::string("surfaces cannot be put aside: ") + std::generic_category().message(errno));
    }
    bytes += written;
    at += written;
    left -= static_cast<std::size_t>(written);
  }
  begins_.push_back(begins_.back() + records.size());
}

SurfelCloud SurfelSpool::read(std::size_t index) const {
  std::vector<Record> records(begins_.at(index + 1) - begins_[index]);
  auto* bytes = reinterpret_cast<char*>(records.data());
  std::size_t left = records.size() * record_size;
  auto at = static_cast<off_t>(begins_[index] * record_size);
  while (left > 0) {
    const ssize_t got = ::pread(descriptor_, bytes, left, at);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) throw input_error(folder_, "surfaces put aside cannot be read back");
    bytes += got;
    at += got;
    left -= static_cast<std::size_t>(got);
  }
  SurfelCloud surfels;
  surfels.means.reserve(records.size());
  surfels.normals.reserve(records.size());
  for (const Record& r : records) {
    surfels.means.emplace_back(r[0], r[1], r[2]);
    surfels.normals.emplace_back(r[3], r[4], r[5]);
  }
  return surfels;
}

}  // namespace kissmap
