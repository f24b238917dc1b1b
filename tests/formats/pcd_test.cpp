// SPDX-License-Identifier: MIT
#include "formats/clouds/pcd.hpp"

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

struct Header {
  std::string fields = "x y z intensity";
  std::string size = "4 4 4 4";
  std::string type = "F F F F";
  std::string count = "1 1 1 1";
  std::string width = "3";
  std::string height = "1";
  std::string points = "3";
  std::string data = "binary";

  std::string text() const {
    return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS " + fields + "\nSIZE " +
           size + "\nTYPE " + type + "\nCOUNT " + count + "\nWIDTH " + width + "\nHEIGHT " +
           height + "\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + points + "\nDATA " + data + "\n";
  }
};

std::string three_points() {
  Bytes bytes;
  for (int i = 1; i <= 12; ++i) bytes.add<float>(static_cast<float>(i));
  return bytes.text();
}

Scan decode(const std::string& file) {
  const Scan scan = ScanDecoder({}).decode(read_pcd(bytes_of(file)), 0);
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

void expect_three_points(const Scan& scan) {
  EXPECT_THAT(scan.points,
              testing::ElementsAre(
                  Eigen::Vector3f(1, 2, 3), Eigen::Vector3f(5, 6, 7), Eigen::Vector3f(9, 10, 11)));
  EXPECT_THAT(scan.intensities, testing::ElementsAre(4, 8, 12));
}

TEST(Pcd, ReadsBinary) {
  expect_three_points(decode(Header().text() + three_points()));
}

// PCL pads its files to a page (trap 17).
TEST(Pcd, IgnoresBytesBehindThePoints) {
  expect_three_points(decode(Header().text() + three_points() + std::string(3967, '\0')));
}

TEST(Pcd, ReadsAscii) {
  Header header;
  header.data = "ascii";
  expect_three_points(decode(header.text() + "1 2 3 4\n5 6 7 8\n9 10 11 12"));
  expect_three_points(decode(header.text() + "\n 1\t2 3.0 4e0 \r\n\n5 6 7 8\r\n9 10 11 12\n\n"));
}

TEST(Pcd, ReadsAsciiNanAsNoReturn) {
  Header header;
  header.data = "ascii";
  const Scan scan = decode(header.text() + "1 2 3 4\nnan nan nan 8\n-nan inf 0 12\n");
  EXPECT_EQ(scan.points.size(), 1U);
  EXPECT_EQ(scan.dropped.non_finite, 2U);
}

// LZF literals only: what any encoder may write for incompressible data.
std::string lzf_literals(const std::string& raw) {
  std::string packed;
  for (std::size_t i = 0; i < raw.size(); i += 32) {
    const std::string run = raw.substr(i, 32);
    packed += static_cast<char>(run.size() - 1);
    packed += run;
  }
  return packed;
}

std::string compressed_file(const Header& header, const std::string& planes) {
  const std::string packed = lzf_literals(planes);
  Bytes sizes;
  sizes.add<std::uint32_t>(static_cast<std::uint32_t>(packed.size()))
      .add<std::uint32_t>(static_cast<std::uint32_t>(planes.size()));
  return header.text() + sizes.text() + packed;
}

TEST(Pcd, ReadsCompressedPlanes) {
  Header header;
  header.data = "binary_compressed";
  Bytes planes;
  for (const float value : {1.F, 5.F, 9.F, 2.F, 6.F, 10.F, 3.F, 7.F, 11.F, 4.F, 8.F, 12.F})
    planes.add<float>(value);
  expect_three_points(decode(compressed_file(header, planes.text())));
}

TEST(Pcd, ReadsFieldsInAnyOrderWithPaddingAndArrays) {
  Header header;
  header.fields = "_ intensity normal z _ y ring x";
  header.size = "1 1 4 8 1 4 2 4";
  header.type = "U U F F U F U F";
  header.count = "3 1 3 1 1 1 1 1";
  header.width = header.points = "2";
  Bytes bytes;
  for (int i = 0; i < 2; ++i) {
    bytes.pad(3).add<std::uint8_t>(static_cast<std::uint8_t>(200 + i)).pad(12);
    bytes.add<double>(3 + i).pad(1).add<float>(static_cast<float>(2 + i));
    bytes.add<std::uint16_t>(7).add<float>(static_cast<float>(1 + i));
  }
  const Scan scan = decode(header.text() + bytes.text());
  EXPECT_THAT(scan.points,
              testing::ElementsAre(Eigen::Vector3f(1, 2, 3), Eigen::Vector3f(2, 3, 4)));
  EXPECT_THAT(scan.intensities, testing::ElementsAre(200, 201));
}

TEST(Pcd, ReadsHeadersOfOlderVersions) {
  const std::string old =
      "# .PCD v.5\r\nVERSION .5\r\nCOLUMNS x y z\r\nSIZE 4 4 4\r\nTYPE F F F\r\n"
      "POINTS 1\r\nDATA ascii\r\n1 2 3\r\n";
  EXPECT_EQ(decode(old).points[0], Eigen::Vector3f(1, 2, 3));
}

TEST(Pcd, MayHoldNoPoints) {
  Header header;
  header.width = header.height = header.points = "0";
  EXPECT_EQ(decode(header.text()).points.size(), 0U);
  header.data = "ascii";
  EXPECT_EQ(decode(header.text()).points.size(), 0U);
}

struct BadHeader {
  const char* what;
  std::string Header::*entry;
  const char* value;
  const char* message;
};

class PcdHeaders : public testing::TestWithParam<BadHeader> {};

TEST_P(PcdHeaders, AreRefusedNamingTheLine) {
  const BadHeader& bad = GetParam();
  Header header;
  header.*bad.entry = bad.value;
  const Refusal caught = refusal(header.text() + three_points());
  EXPECT_STREQ(caught.reason(), refusal_reason::broken_header);
  EXPECT_THAT(caught.what(), HasSubstr(bad.message));
}

INSTANTIATE_TEST_SUITE_P(
    All,
    PcdHeaders,
    testing::Values(
        BadHeader{"FewSizes", &Header::size, "4 4 4", "line 4: 3 values in SIZE but 4 names"},
        BadHeader{"ManyTypes", &Header::type, "F F F F F", "line 5: 5 values in TYPE"},
        BadHeader{"FewCounts", &Header::count, "1", "line 6: 1 values in COUNT"},
        BadHeader{"Size3", &Header::size, "4 4 4 3", "line 5: there is no type 'F' of 3 bytes"},
        BadHeader{"SizeNegative", &Header::size, "4 4 4 -4", "line 4: '-4' is no valid SIZE"},
        BadHeader{"SizeText", &Header::size, "4 4 4 q", "line 4: 'q' is no valid SIZE"},
        BadHeader{"TypeText", &Header::type, "F F F Q", "line 5: there is no type 'Q'"},
        BadHeader{"CountZero", &Header::count, "1 1 1 0", "line 6: COUNT of intensity"},
        BadHeader{"CountHuge", &Header::count, "1 1 1 4000000000", "line 6: COUNT of intensity"},
        BadHeader{"CountLarge", &Header::count, "1 1 1 1000000", "more than 1 MiB"},
        BadHeader{"PointsDiffer", &Header::points, "4", "line 10: POINTS is '4' but WIDTH"},
        BadHeader{"HeightLies", &Header::height, "7", "WIDTH x HEIGHT is 21"},
        BadHeader{"WidthWraps", &Header::width, "9223372036854775809", "line"},
        BadHeader{"WidthText", &Header::width, "three", "line 7: 'three' is no valid WIDTH"},
        BadHeader{"Encoding", &Header::data, "zipped", "line 11: DATA is 'zipped'"},
        BadHeader{"NoFields", &Header::fields, "", "line 4: 4 values in SIZE but 0 names"}),
    [](const auto& test) { return test.param.what; });

TEST(Pcd, WidthTimesHeightMustNotWrap) {
  Header header;
  header.width = header.height = "4294967297";
  header.points = "8589934593";  // the product modulo 2^64
  EXPECT_THAT(refusal(header.text()).what(), HasSubstr("WIDTH is too large"));
}

TEST(Pcd, SaysHowMuchOfATruncatedFileIsThere) {
  const std::string whole = Header().text() + three_points();
  const Refusal caught = refusal(whole.substr(0, whole.size() - 1));
  EXPECT_STREQ(caught.reason(), refusal_reason::truncated);
  EXPECT_THAT(caught.what(), HasSubstr("3 points of 16 bytes are promised"));
  EXPECT_THAT(caught.what(), HasSubstr("47 bytes behind the header"));
  EXPECT_STREQ(refusal(whole.substr(0, 50)).reason(), refusal_reason::truncated);
}

TEST(Pcd, RefusesHugePromisesWithoutAllocating) {
  Header header;
  header.width = header.points = "2000000000";
  for (const char* data : {"binary", "ascii", "binary_compressed"}) {
    header.data = data;
    EXPECT_NE(refusal(header.text() + three_points()).reason(), nullptr) << data;
  }
}

TEST(Pcd, RefusesAsciiLinesThatDoNotFit) {
  Header header;
  header.data = "ascii";
  const auto message = [&](const char* lines) {
    return std::string(refusal(header.text() + lines).what());
  };
  EXPECT_THAT(message("1 2 3 4\n5 6 7\n9 9 9 9\n"),
              HasSubstr("line 13: no value for field intens"));
  EXPECT_THAT(message("1 2 3 4\n5 6 7 8 9\n"), HasSubstr("line 13: more values than fields"));
  EXPECT_THAT(message("1 2 3 4\n5 x 7 8\n"), HasSubstr("line 13: 'x' is no value for field y"));
  EXPECT_THAT(message("1 2 3 4\n5,5 6 7 8\n"), HasSubstr("'5,5'"));
  EXPECT_THAT(message("1 2 3 4\n5 6 7 8\n"), HasSubstr("the file ends after 2"));
  EXPECT_THAT(message("1 2 3 4\n5 6 7 8\n1 1 1 1\n2 2 2 2\n"), HasSubstr("line 15: more points"));
}

TEST(Pcd, RefusesDamagedCompression) {
  Header header;
  header.data = "binary_compressed";
  const auto file = [&](std::uint32_t packed, std::uint32_t raw, const std::string& payload) {
    return header.text() + Bytes().add<std::uint32_t>(packed).add<std::uint32_t>(raw).text() +
           payload;
  };
  EXPECT_STREQ(refusal(file(10, 48, std::string(10, '\xff'))).reason(),
               refusal_reason::broken_content);
  EXPECT_STREQ(refusal(file(4'000'000'000, 48, "0123456789")).reason(), refusal_reason::truncated);
  EXPECT_STREQ(refusal(file(10, 4'000'000'000, "0123456789")).reason(),
               refusal_reason::broken_header);
  EXPECT_STREQ(refusal(file(0, 48, "")).reason(), refusal_reason::broken_content);
  EXPECT_STREQ(refusal(header.text() + "abc").reason(), refusal_reason::truncated);
}

TEST(Pcd, RefusesCompressionBeyondWhatLzfCanDo) {
  // 48 MB from 8 bytes: a header and sizes that agree with each other, but not with LZF.
  Header header;
  header.data = "binary_compressed";
  header.width = header.points = "3000000";
  const std::string sizes =
      Bytes().add<std::uint32_t>(8).add<std::uint32_t>(48'000'000).text() + "01234567";
  EXPECT_STREQ(refusal(header.text() + sizes).reason(), refusal_reason::broken_content);
}

}  // namespace
}  // namespace kissmap
