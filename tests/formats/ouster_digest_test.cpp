// SPDX-License-Identifier: MIT
// Digests that the maker's own tool made of recordings: MD5 of each field, packet by packet as they
// came (rows by beam, columns of the packet) and as an image of the frame. All are compared.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <nlohmann/json.hpp>

#include "formats/containers/packet_capture.hpp"
#include "formats/sensors/ouster_packet.hpp"
#include "formats/support.hpp"
#include "support/program.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::TempDir;

/// A field and how the digest writes its values.
struct Digested {
  OusterField field;
  std::size_t bytes = 0;
  std::uint64_t factor = 1;
};

/// Fields of a profile that has digests among the recordings, by the names the digests use.
std::map<std::string, Digested> digested_fields(const OusterProfile& profile) {
  const bool coarse = profile.range_step_mm == 8;
  std::map<std::string, Digested> fields{{"RANGE", {profile.range[0], 4, profile.range_step_mm}},
                                         {"REFLECTIVITY", {profile.reflectivity[0], 1, 1}},
                                         {"NEAR_IR", {profile.near_ir, 2, coarse ? 16U : 1U}}};
  if (!coarse) fields["SIGNAL"] = {profile.signal[0], 2, 1};
  // What kissmap has no use for is between what it reads.
  const unsigned end_of_range = profile.range[0].width;
  const OusterField flags = profile.name == "LEGACY" ? OusterField{28, 4}
                            : coarse                 ? OusterField{end_of_range, 1}
                                                     : OusterField{end_of_range, 5};
  fields["FLAGS"] = {flags, 1, 1};
  for (unsigned word = 0; profile.name != "LEGACY" && word < profile.pixel_bytes / 4; ++word) {
    fields["RAW32_WORD" + std::to_string(word + 1)] = {{32 * word, 32}, 4, 1};
  }
  return fields;
}

void append(std::string& to, std::uint64_t value, std::size_t bytes) {
  for (std::size_t i = 0; i < bytes; ++i) to += static_cast<char>((value >> (8 * i)) & 255U);
}

/// What the digests are made of.
struct Images {
  std::map<std::string, std::string> packets;               ///< the bytes themselves
  std::map<std::string, std::vector<std::uint64_t>> frame;  ///< values by place
  std::uint16_t frame_id = 0;
};

/// The encoder's angle, which only the oldest profile has: the last four bytes before the pixels.
std::uint32_t encoder_of(const OusterColumn& column, bool legacy) {
  std::uint32_t encoder = 0;
  if (legacy) std::memcpy(&encoder, column.pixels.data() - sizeof(encoder), sizeof(encoder));
  return encoder;
}

class DigestMaker {
 public:
  explicit DigestMaker(const OusterMetadata& about)
      : about_(about),
        packets_(about),
        legacy_(packets_.profile().name == "LEGACY"),
        fields_(digested_fields(packets_.profile())) {
    const std::size_t width = about.columns_per_frame;
    for (const auto& [name, field] : fields_) images_.frame[name].resize(about.beams * width);
    for (const char* name : {"TIMESTAMP", "STATUS", "MEASUREMENT_ID", "ENCODER_COUNT"}) {
      images_.frame[name].resize(width);
    }
  }

  void add(std::span<const std::byte> payload) {
    if (payload.size() != packets_.packet_bytes()) return;
    std::vector<OusterColumn> columns;
    for (std::size_t i = 0; i < about_.columns_per_packet; ++i) {
      columns.push_back(packets_.column(payload, i));
      add_column(columns.back());
    }
    for (const auto& [name, digested] : fields_) {
      for (std::size_t beam = 0; beam < about_.beams; ++beam) {
        for (const OusterColumn& column : columns) {
          append(images_.packets[name], value(column, beam, digested), digested.bytes);
        }
      }
    }
  }

  const Images& images() const { return images_; }
  std::size_t bytes_of(const std::string& name) const { return fields_.at(name).bytes; }

 private:
  std::uint64_t value(const OusterColumn& column, std::size_t beam, const Digested& of) const {
    const std::size_t size = packets_.profile().pixel_bytes;
    return OusterPackets::read(column.pixels.subspan(beam * size, size), of.field) * of.factor;
  }

  void add_column(const OusterColumn& column) {
    const std::uint32_t encoder = encoder_of(column, legacy_);
    append(images_.packets["TIMESTAMP"], column.timestamp_ns, 8);
    append(images_.packets["STATUS"], column.status, 4);
    append(images_.packets["MEASUREMENT_ID"], column.measurement_id, 2);
    append(images_.packets["ENCODER_COUNT"], encoder, 4);
    // The tool fills in the frame of each column only where columns have one of their own.
    append(images_.packets["FRAME_ID"], legacy_ ? column.frame_id : 0, 2);
    EXPECT_TRUE(column.valid);
    images_.frame_id = column.frame_id;
    const std::size_t place = column.measurement_id;
    images_.frame["TIMESTAMP"].at(place) = column.timestamp_ns;
    images_.frame["STATUS"][place] = column.status;
    images_.frame["MEASUREMENT_ID"][place] = column.measurement_id;
    images_.frame["ENCODER_COUNT"][place] = encoder;
    for (const auto& [name, digested] : fields_) {
      for (std::size_t beam = 0; beam < about_.beams; ++beam) {
        images_.frame[name][beam * about_.columns_per_frame + place] =
            value(column, beam, digested);
      }
    }
  }

  OusterMetadata about_;
  OusterPackets packets_;
  bool legacy_;
  std::map<std::string, Digested> fields_;
  Images images_;
};

std::string md5(const TempDir& dir, const std::string& bytes) {
  const ProgramResult result = run_program({"md5sum", dir.write("image", bytes).string()});
  return result.out.substr(0, 32);
}

class Digests : public testing::TestWithParam<const char*> {};

TEST_P(Digests, OfEveryFieldAreEqual) {
  const char* data = std::getenv("KISSMAP_TEST_DATA");
  if (data == nullptr) GTEST_SKIP() << "needs the recordings";
  const fs::path stem = fs::path(data) / "packets/ouster" / GetParam();
  const fs::path json_file = stem.string() + ".json";
  DigestMaker maker(read_ouster_metadata(file_text(json_file), json_file));
  PacketCapture capture(stem.string() + ".pcap");
  Datagram datagram;
  while (capture.next(datagram)) maker.add(datagram.payload);
  const TempDir dir;
  const json digests = json::parse(file_text(stem.string() + "_digest.json"));
  for (const auto& [name, digest] : digests["packet_hash"].items()) {
    const auto found = maker.images().packets.find(name);
    ASSERT_NE(found, maker.images().packets.end()) << name;
    EXPECT_EQ(md5(dir, found->second), digest) << name;
  }
  ASSERT_EQ(digests["scans"].size(), 1U);
  const std::map<std::string, std::size_t> of_columns{
      {"TIMESTAMP", 8}, {"STATUS", 8}, {"MEASUREMENT_ID", 2}, {"ENCODER_COUNT", 8}};
  for (const auto& [name, digest] : digests["scans"][0].items()) {
    if (name == "FRAME_ID") {
      EXPECT_EQ(std::to_string(maker.images().frame_id), digest);
      continue;
    }
    const auto found = maker.images().frame.find(name);
    ASSERT_NE(found, maker.images().frame.end()) << name;
    const auto of_column = of_columns.find(name);
    const std::size_t size =
        of_column == of_columns.end() ? maker.bytes_of(name) : of_column->second;
    std::string image;
    for (const std::uint64_t value : found->second) append(image, value, size);
    EXPECT_EQ(md5(dir, image), digest) << name;
  }
}

INSTANTIATE_TEST_SUITE_P(Recordings,
                         Digests,
                         testing::Values("OS-1-32-G_v2.1.1_1024x10",
                                         "OS-2-128-U1_v2.3.0_1024x10",
                                         "OS-0-128-U1_v2.3.0_1024x10"));

}  // namespace
}  // namespace kissmap
