// SPDX-License-Identifier: MIT
// Captures written byte by byte: containers, links, fragments.
#include "formats/containers/packet_capture.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "formats/capture_bytes.hpp"
#include "formats/support.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;
using test::big16;
using test::Bytes;
using test::error_of;
using test::ethernet;
using test::ipv4;
using test::pcap;
using test::pcap_head;
using test::pcap_record;
using test::TempDir;
using test::udp;
using testing::ElementsAre;
using testing::HasSubstr;

struct Read {
  std::vector<std::string> payloads;
  std::vector<std::int64_t> times;
  std::optional<ContainerDamage> damage;
  PassedOver passed_over;
};

Read read(const std::string& content) {
  const TempDir dir;
  PacketCapture capture(dir.write("c.pcap", content));
  Read result;
  Datagram datagram;
  while (capture.next(datagram)) {
    EXPECT_EQ(datagram.destination_port, 2368);
    EXPECT_EQ(datagram.source_port, 5000);
    result.payloads.emplace_back(reinterpret_cast<const char*>(datagram.payload.data()),
                                 datagram.payload.size());
    result.times.push_back(datagram.received_ns);
  }
  result.damage = capture.damage();
  result.passed_over = capture.passed_over();
  return result;
}

TEST(PacketCapture, OfBothResolutionsAndByteOrders) {
  for (const std::endian order : {std::endian::little, std::endian::big}) {
    for (const bool nanoseconds : {false, true}) {
      const std::string file = pcap_head(1, order, nanoseconds ? 0xA1B23C4D : 0xA1B2C3D4) +
                               pcap_record(ethernet(ipv4(udp(2368, "hello"))), 123456, order);
      const Read got = read(file);
      EXPECT_THAT(got.payloads, ElementsAre("hello"));
      EXPECT_THAT(got.times,
                  ElementsAre(1'700'000'000'000'000'000 + (nanoseconds ? 123456 : 123456000)));
      EXPECT_FALSE(got.damage.has_value());
    }
  }
}

TEST(PacketCapture, OfEveryLink) {
  const std::string packet = ipv4(udp(2368, "x"));
  const std::string type = "\x08" + std::string(1, '\0');
  const std::string vlan = "\x81" + std::string("\x00\x00\x05", 3);
  EXPECT_THAT(read(pcap({std::string(12, 'm') + vlan + type + packet})).payloads, ElementsAre("x"));
  EXPECT_THAT(read(pcap({std::string(12, 'm') + vlan + vlan + type + packet})).payloads,
              ElementsAre("x"));
  EXPECT_THAT(read(pcap({std::string(14, 'c') + type + packet}, 113)).payloads, ElementsAre("x"));
  EXPECT_THAT(read(pcap({type + std::string(18, 'c') + packet}, 276)).payloads, ElementsAre("x"));
  EXPECT_THAT(read(pcap({packet}, 101)).payloads, ElementsAre("x"));
  EXPECT_THAT(read(pcap({packet}, 228)).payloads, ElementsAre("x"));
  EXPECT_THAT(read(pcap({std::string(4, '\x02') + packet}, 0)).payloads, ElementsAre("x"));
  EXPECT_EQ(read(pcap({packet}, 147)).passed_over.not_udp, 1U);
}

TEST(PacketCapture, OfIpv6WithAndWithoutFragments) {
  const std::string addresses(32, 'a');
  const auto ipv6 = [&](char next, const std::string& content) {
    return std::string("\x60\x00\x00\x00", 4) + big16(content.size()) + next + "\x40" + addresses +
           content;
  };
  EXPECT_THAT(read(pcap({ipv6(17, udp(2368, "six"))}, 101)).payloads, ElementsAre("six"));
  const std::string whole = udp(2368, std::string(24, 'p'));
  const auto piece = [&](std::size_t offset, std::size_t size, bool more) {
    return ipv6(44,
                std::string("\x11\x00", 2) + big16(offset | (more ? 1U : 0U)) +
                    std::string("\x00\x00\x00\x09", 4) + whole.substr(offset, size));
  };
  EXPECT_THAT(read(pcap({piece(16, 16, false), piece(0, 16, true)}, 101)).payloads,
              ElementsAre(std::string(24, 'p')));
}

// 40 bytes of payload with the 8 of the header, in pieces of 16.
std::vector<std::string> fragments(std::uint16_t id, const std::string& payload) {
  const std::string whole = udp(2368, payload);
  std::vector<std::string> pieces;
  for (std::size_t at = 0; at < whole.size(); at += 16) {
    const bool more = at + 16 < whole.size();
    pieces.push_back(ethernet(ipv4(whole.substr(at, 16), id, at / 8 + (more ? 0x2000 : 0))));
  }
  return pieces;
}

TEST(PacketCapture, FragmentsComeInAnyOrderTwiceAndMixed) {
  const std::string a(40, 'a');
  const std::string b(37, 'b');
  const auto fa = fragments(1, a);
  const auto fb = fragments(2, b);
  EXPECT_THAT(read(pcap({fa[2], fb[0], fa[0], fa[0], fb[2], fa[1], fb[1]})).payloads,
              ElementsAre(a, b));
  const Read incomplete = read(pcap({fa[0], fa[2]}));
  EXPECT_TRUE(incomplete.payloads.empty());
}

TEST(PacketCapture, FragmentsOfAFewDatagramsAreKept) {
  std::vector<std::string> frames;
  for (std::uint16_t id = 0; id < 1000; ++id) {
    frames.push_back(fragments(id, std::string(40, 'a'))[0]);
  }
  const Read got = read(pcap(frames));
  EXPECT_TRUE(got.payloads.empty());
  EXPECT_EQ(got.passed_over.incomplete, 1000U - 64);
}

TEST(PacketCapture, WhatIsNoDatagramIsCounted) {
  const std::string good = udp(2368, "good");
  std::string long_length = udp(2368, "x");
  long_length[4] = '\x7f';
  const std::string file = pcap({ethernet(ipv4(good)),
                                 ethernet(ipv4(good, 1, 0, 6)),
                                 ethernet(ipv4(long_length)),
                                 ethernet(ipv4(good).substr(0, 30)),
                                 "short",
                                 ethernet(std::string("\x45", 1))}) +
                           pcap_record(ethernet(ipv4(good)), 5, std::endian::little, 2000);
  const Read got = read(file);
  EXPECT_THAT(got.payloads, ElementsAre("good"));
  EXPECT_EQ(got.passed_over.not_udp, 2U);
  EXPECT_EQ(got.passed_over.malformed, 3U);
  EXPECT_EQ(got.passed_over.cut_short, 1U);
}

TEST(PacketCapture, NextGenerationInBothByteOrdersWithSections) {
  std::string file;
  for (const std::endian order : {std::endian::little, std::endian::big}) {
    file += test::pcapng_head(order) + test::pcapng_block(0x777, "whatever", order) +
            test::pcapng_packet(ethernet(ipv4(udp(2368, "ng"))), 1'700'000'000'000'000'007, order);
  }
  const Read got = read(file);
  EXPECT_THAT(got.payloads, ElementsAre("ng", "ng"));
  EXPECT_THAT(got.times, ElementsAre(1'700'000'000'000'000'007, 1'700'000'000'000'000'007));
  EXPECT_FALSE(got.damage.has_value());
}

TEST(PacketCapture, CutAnywhereGivesWhatCameBefore) {
  const std::string record = pcap_record(ethernet(ipv4(udp(2368, "payload"))));
  const std::string head = pcap({});
  const std::string file = head + record + record + record;
  for (std::size_t size = 0; size <= file.size(); ++size) {
    if (size < head.size()) {
      const TempDir dir;
      const fs::path path = dir.write("c.pcap", file.substr(0, size));
      EXPECT_THAT(error_of(Fault::input, [&] { PacketCapture capture(path); }),
                  HasSubstr("c.pcap"));
      continue;
    }
    const Read got = read(file.substr(0, size));
    EXPECT_EQ(got.payloads.size(), (size - head.size()) / record.size());
    EXPECT_EQ(got.damage.has_value(), (size - head.size()) % record.size() != 0);
  }
}

TEST(PacketCapture, HostileLengthsAreDamage) {
  std::string file = pcap({ethernet(ipv4(udp(2368, "good")))});
  file += Bytes()
              .add<std::uint32_t>(1)
              .add<std::uint32_t>(1)
              .add<std::uint32_t>(0xFFFFFFFF)
              .add<std::uint32_t>(0)
              .text();
  const Read got = read(file + std::string(1000, 'x'));
  EXPECT_THAT(got.payloads, ElementsAre("good"));
  ASSERT_TRUE(got.damage.has_value());
  EXPECT_EQ(got.damage->reason, "broken content");
}

}  // namespace
}  // namespace kissmap
