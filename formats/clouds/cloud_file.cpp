// SPDX-License-Identifier: MIT
#include "formats/clouds/cloud_file.hpp"

#include <cctype>
#include <string_view>

#include "formats/clouds/bin.hpp"
#include "formats/clouds/las_reader.hpp"
#include "formats/clouds/npy.hpp"
#include "formats/clouds/pcd.hpp"
#include "formats/clouds/ply.hpp"
#include "formats/clouds/refusal.hpp"
#include "formats/clouds/text_cloud.hpp"
#include "formats/text/lines.hpp"

namespace kissmap {
namespace {

struct Mark {
  std::string_view bytes;
  const char* kind;
};

using namespace std::string_view_literals;

constexpr Mark foreign_marks[] = {{"#ROSBAG V"sv, "ROS bag"},
                                  {"\x89MCAP0\r\n"sv, "MCAP file"},
                                  {"SQLite format 3"sv, "SQLite database"},
                                  {"\x93NUMPY"sv, "NumPy array"},
                                  {"LASF"sv, "LAS file"},
                                  {"PK\x03\x04"sv, "zip archive"},
                                  {"\x1f\x8b"sv, "gzip archive"},
                                  {"\x28\xb5\x2f\xfd"sv, "zstd archive"},
                                  {"\xd4\xc3\xb2\xa1"sv, "pcap capture"},
                                  {"\xa1\xb2\xc3\xd4"sv, "pcap capture"},
                                  {"\x4d\x3c\xb2\xa1"sv, "pcap capture"},
                                  {"\xa1\xb2\x3c\x4d"sv, "pcap capture"},
                                  {"\x0a\x0d\x0d\x0a"sv, "pcapng capture"},
                                  {"\x89PNG\r\n"sv, "PNG picture"},
                                  {"\xff\xd8\xff"sv, "JPEG picture"},
                                  {"<!DOCTYPE"sv, "web page"},
                                  {"<html"sv, "web page"},
                                  {"version https://git-lfs"sv, "Git LFS pointer"}};

const char* name_of(CloudKind kind) {
  constexpr const char* names[] = {"PCD", "PLY", "BIN", "NumPy array", "text", "LAS file"};
  return names[static_cast<std::size_t>(kind)];
}

}  // namespace

std::optional<CloudKind> kind_by_name(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (extension == ".pcd") return CloudKind::pcd;
  if (extension == ".ply") return CloudKind::ply;
  if (extension == ".bin") return CloudKind::bin;
  if (extension == ".npy") return CloudKind::npy;
  if (extension == ".las") return CloudKind::las;
  if (extension == ".xyz") return CloudKind::text;
  const std::string stem = path.stem().string();
  const bool numbered = !stem.empty() && stem.back() >= '0' && stem.back() <= '9';
  if (extension == ".csv" && numbered) return CloudKind::text;
  return std::nullopt;
}

std::optional<std::string> kind_by_content(std::span<const std::byte> first_bytes) {
  if (looks_like_pcd(first_bytes)) return "PCD";
  if (looks_like_ply(first_bytes)) return "PLY";
  for (const Mark& mark : foreign_marks) {
    if (text_of(first_bytes).starts_with(mark.bytes)) return mark.kind;
  }
  return std::nullopt;
}

PointRecords read_cloud(std::span<const std::byte> file, CloudKind kind, int bin_columns) {
  if (file.empty()) throw Refusal(refusal_reason::empty, "the file has 0 bytes; copy it anew");
  const auto content = kind_by_content(file.first(std::min(file.size(), probe_size)));
  if (content && *content != name_of(kind)) {
    throw Refusal(refusal_reason::wrong_kind,
                  std::string("named as ") + name_of(kind) + " but begins like a " + *content +
                      "; rename or remove it");
  }
  switch (kind) {
    case CloudKind::pcd:
      return read_pcd(file);
    case CloudKind::ply:
      return read_ply(file);
    case CloudKind::npy:
      return read_npy(file);
    case CloudKind::text:
      return read_text_cloud(file);
    case CloudKind::las:
      return read_las(file);
    case CloudKind::bin:
      break;
  }
  return read_bin(file, bin_columns);
}

}  // namespace kissmap
