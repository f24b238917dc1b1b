// SPDX-License-Identifier: MIT
#include "formats/clouds/ply.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "formats/clouds/refusal.hpp"
#include "formats/clouds/scan_decoder.hpp"
#include "formats/support.hpp"

namespace kissmap {
namespace {

using test::Bytes;
using test::bytes_of;
using testing::HasSubstr;

Scan decode(const std::string& file) {
  const Scan scan = ScanDecoder({}).decode(read_ply(bytes_of(file)), 0);
  require_consistent(scan);
  return scan;
}

Refusal refusal(const std::string& file) {
  try {
    decode(file);
  } catch (const Refusal& caught) {
    return caught;
  }
  ADD_FAILURE() << "was read: " << file.substr(0, 400);
  return {"", ""};
}

const std::string vertex = "property float x\nproperty float y\nproperty float z\n";

std::string header(const std::string& format, const std::string& body) {
  return "ply\nformat " + format + " 1.0\ncomment made for a test\n" + body + "end_header\n";
}

const char* format_name(std::endian order) {
  return order == std::endian::little ? "binary_little_endian" : "binary_big_endian";
}

TEST(Ply, ReadsAscii) {
  const std::string body = "element vertex 2\n" + vertex + "property uchar intensity\n";
  const Scan scan = decode(header("ascii", body) + "1 2 3 4\n5 6 7 255\n");
  EXPECT_THAT(scan.points,
              testing::ElementsAre(Eigen::Vector3f(1, 2, 3), Eigen::Vector3f(5, 6, 7)));
  EXPECT_THAT(scan.intensities, testing::ElementsAre(4, 255));
}

TEST(Ply, ReadsCarriageReturns) {
  EXPECT_EQ(decode("ply\r\nformat ascii 1.0\r\nelement vertex 1\r\nproperty float x\r\n"
                   "property float y\r\nproperty float z\r\nend_header\r\n1 2 3\r\n")
                .points[0],
            Eigen::Vector3f(1, 2, 3));
}

TEST(Ply, PassesOverOtherElementsAndListsInBinary) {
  for (const std::endian order : {std::endian::little, std::endian::big}) {
    const std::string body =
        "element camera 2\nproperty double view\nproperty short id\n"
        "element face 2\nproperty list uchar int vertex_indices\nproperty list ushort double w\n"
        "element vertex 2\n" +
        vertex + "property list int uchar echoes\nproperty double t\n";
    Bytes bytes(order);
    for (int i = 0; i < 2; ++i) bytes.add<double>(9.5).add<std::int16_t>(3);
    for (int n = 0; n < 2; ++n) {
      bytes.add<std::uint8_t>(static_cast<std::uint8_t>(n)).pad(4 * static_cast<std::size_t>(n));
      bytes.add<std::uint16_t>(1).add<double>(0.5);
    }
    for (int i = 0; i < 2; ++i) {
      const auto v = static_cast<float>(i);
      bytes.add<float>(1 + v).add<float>(2 + v).add<float>(3 + v);
      bytes.add<std::int32_t>(3 - i).pad(static_cast<std::size_t>(3 - i)).add<double>(0.1 * i);
    }
    const Scan scan = decode(header(format_name(order), body) + bytes.text());
    EXPECT_THAT(scan.points,
                testing::ElementsAre(Eigen::Vector3f(1, 2, 3), Eigen::Vector3f(2, 3, 4)));
    EXPECT_THAT(scan.time_offsets, testing::ElementsAre(0.0F, 0.1F));
  }
}

TEST(Ply, PassesOverOtherElementsAndListsInAscii) {
  const std::string body =
      "element face 2\nproperty list uchar int vertex_indices\n"
      "element vertex 2\n" +
      vertex + "property list uchar int echoes\nproperty float intensity\n";
  const Scan scan = decode(header("ascii", body) + "3 0 1 2\n0\n1 2 3 2 8 8 4\n5 6 7 0 8\n");
  EXPECT_THAT(scan.intensities, testing::ElementsAre(4, 8));
}

// The list's length may be any integer type; -1 must not become a huge step.
TEST(Ply, RefusesListsThatReachBeyondTheFile) {
  for (const char* type : {"char", "short", "int", "uint", "int64", "uint64"}) {
    const std::string body = std::string("element face 1\nproperty list ") + type +
                             " double v\nelement vertex 1\n" + vertex;
    const Refusal caught = refusal(header("binary_little_endian", body) + std::string(60, '\xff'));
    EXPECT_STREQ(caught.reason(), refusal_reason::truncated) << type;
  }
}

TEST(Ply, SaysWhereATruncatedFileEnds) {
  const std::string file = header("binary_little_endian", "element vertex 3\n" + vertex);
  const Refusal caught = refusal(file + std::string(35, '\1'));
  EXPECT_STREQ(caught.reason(), refusal_reason::truncated);
  EXPECT_THAT(caught.what(), HasSubstr("byte " + std::to_string(file.size())));
  EXPECT_STREQ(refusal(header("ascii", "element vertex 3\n" + vertex) + "1 2 3\n").reason(),
               refusal_reason::truncated);
  EXPECT_STREQ(refusal(file.substr(0, 30)).reason(), refusal_reason::truncated);
}

TEST(Ply, RefusesHugePromisesWithoutAllocating) {
  for (const char* format : {"ascii", "binary_little_endian"}) {
    for (const char* count : {"18446744073709551615", "4611686018427387905", "2000000000"}) {
      const std::string body = std::string("element vertex ") + count + "\n" + vertex;
      EXPECT_STREQ(refusal(header(format, body) + "1 2 3\n").reason(), refusal_reason::truncated);
    }
  }
}

TEST(Ply, RefusesBrokenHeadersNamingTheLine) {
  const auto message = [](const std::string& body) {
    const Refusal caught = refusal("ply\nformat ascii 1.0\n" + body + "end_header\n1 2 3\n");
    EXPECT_STREQ(caught.reason(), refusal_reason::broken_header);
    return std::string(caught.what());
  };
  EXPECT_THAT(message("element vertex -1\n"), HasSubstr("line 3: '-1' is no number of elements"));
  EXPECT_THAT(message("element vertex\n"), HasSubstr("line 3: ''"));
  EXPECT_THAT(message("property float x\n"), HasSubstr("line 3: a property before any element"));
  EXPECT_THAT(message("element vertex 1\nproperty half x\n"),
              HasSubstr("line 4: 'half' is no PLY"));
  EXPECT_THAT(message("element vertex 1\nproperty float\n"), HasSubstr("without a name"));
  EXPECT_THAT(message("element vertex 1\nproperty list float int x\n"), HasSubstr("fraction"));
  EXPECT_THAT(message("elements vertex 1\n"), HasSubstr("'elements' is no PLY header entry"));
  EXPECT_THAT(refusal("ply\nformat binary 1.0\nend_header\n").what(), HasSubstr("line 2"));
  EXPECT_THAT(refusal("ply\nformat ascii 2.0\nend_header\n").what(), HasSubstr("version '2.0'"));
  EXPECT_THAT(refusal("ply\nelement vertex 0\nend_header\n").what(), HasSubstr("no format"));
  EXPECT_THAT(refusal("plyformat\n").what(), HasSubstr("line 1"));
}

TEST(Ply, NeedsVerticesWithCoordinates) {
  EXPECT_STREQ(refusal(header("ascii", "element face 0\n")).reason(),
               refusal_reason::no_coordinates);
  EXPECT_STREQ(refusal(header("ascii", "element vertex 5\n")).reason(),
               refusal_reason::no_coordinates);
  EXPECT_STREQ(refusal(header("ascii", "element vertex 1\nproperty float x\n") + "1\n").reason(),
               refusal_reason::no_coordinates);
}

}  // namespace
}  // namespace kissmap
