// SPDX-License-Identifier: MIT
// Captures cut at every hundredth of their length: the sweeps of exactly the packets that lie
// before the cut, the last sweep as far as it was begun.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <memory>

#include "formats/capture_bytes.hpp"
#include "formats/sensor_recording.hpp"
#include "formats/sensors/ouster_decoder.hpp"
#include "formats/sensors/velodyne_decoder.hpp"
#include "formats/support.hpp"
#include "support/program.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;
using test::bytes_of;
using test::read_all;
using test::scan_of;
using test::TempDir;
using testing::HasSubstr;

/// A frame of a capture, and where in the file it ends.
struct Frame {
  std::size_t end = 0;
  std::int64_t ns = 0;
  std::string bytes;
};

std::uint32_t little32(const std::string& text, std::size_t at) {
  std::uint32_t value = 0;
  std::memcpy(&value, text.data() + at, sizeof(value));
  return value;
}

std::size_t big16_of(const std::string& text, std::size_t at) {
  return std::size_t{static_cast<std::uint8_t>(text.at(at))} * 256 +
         static_cast<std::uint8_t>(text.at(at + 1));
}

/// Of a little-endian pcap in microseconds.
std::vector<Frame> frames_of(const std::string& pcap) {
  std::vector<Frame> frames;
  for (std::size_t at = 24; at < pcap.size();) {
    const std::size_t size = little32(pcap, at + 8);
    const std::int64_t us = std::int64_t{little32(pcap, at)} * 1'000'000 + little32(pcap, at + 4);
    frames.push_back({at + 16 + size, us * 1000, pcap.substr(at + 16, size)});
    at += 16 + size;
  }
  return frames;
}

struct Packet {
  std::size_t end = 0;
  std::int64_t ns = 0;
  std::string payload;
};

/// UDP datagrams of IPv4 over Ethernet, whose pieces follow one another.
std::vector<Packet> packets_of(const std::vector<Frame>& frames) {
  constexpr std::size_t ethernet = 14;
  std::vector<Packet> packets;
  std::string pieces;
  for (const Frame& frame : frames) {
    if (frame.bytes.substr(ethernet, 1) != "\x45") continue;  // 20 bytes of header
    const std::size_t size = big16_of(frame.bytes, ethernet + 2);
    const std::size_t place = big16_of(frame.bytes, ethernet + 6);
    if ((place & 0x1FFFU) == 0) pieces.clear();
    pieces += frame.bytes.substr(ethernet + 20, size - 20);
    if ((place & 0x2000U) != 0) continue;
    packets.push_back({frame.end, frame.ns, pieces.substr(8)});
  }
  return packets;
}

using MakeDecoder = std::function<std::unique_ptr<PacketDecoder>()>;

std::vector<Scan> sweeps_before(const std::vector<Packet>& packets,
                                std::size_t cut,
                                const MakeDecoder& make) {
  const auto decoder = make();
  for (const Packet& packet : packets) {
    if (packet.end <= cut) decoder->add(bytes_of(packet.payload), packet.ns);
  }
  decoder->finish();
  return test::take_all(*decoder);
}

void expect_same(const Scan& scan, const Scan& expected) {
  EXPECT_EQ(scan.stamp_ns, expected.stamp_ns);
  EXPECT_TRUE(scan.points == expected.points);
  EXPECT_TRUE(scan.intensities == expected.intensities);
  EXPECT_TRUE(scan.time_offsets == expected.time_offsets);
}

/// `frames` are those of `content`, a capture named `name`.
void expect_sweeps_before_cuts(const TempDir& dir,
                               const std::string& name,
                               const std::string& content,
                               const std::vector<Frame>& frames,
                               const MakeDecoder& make) {
  const std::vector<Packet> packets = packets_of(frames);
  ASSERT_GT(sweeps_before(packets, content.size(), make).size(), 1U);
  for (std::size_t percent = 0; percent < 100; ++percent) {
    SCOPED_TRACE(name + " at " + std::to_string(percent) + " %");
    const std::size_t size = content.size() * percent / 100;
    const std::vector<Scan> expected = sweeps_before(packets, size, make);
    const fs::path cut = dir.write(name, content.substr(0, size));
    std::vector<LogEntry> entries;
    try {
      entries = read_all(*open_log(cut));
    } catch (const Error& error) {
      EXPECT_EQ(error.fault(), Fault::input);
      EXPECT_THAT(error.what(), HasSubstr(name));
      EXPECT_TRUE(expected.empty());
      continue;
    }
    ASSERT_FALSE(entries.empty());
    // A cut between two frames cannot be told from the end of the recording.
    const bool between = std::ranges::find(frames, size, &Frame::end) != frames.end();
    if (!between) {
      EXPECT_EQ(test::refusal_of(entries.back()).reason, "truncated file");
      entries.pop_back();
    }
    ASSERT_EQ(entries.size(), expected.size());
    for (std::size_t i = 0; i < entries.size(); ++i) expect_same(scan_of(entries[i]), expected[i]);
  }
}

class CutCaptures : public test::PacketRecordings {
 protected:
  TempDir dir_;
};

TEST_F(CutCaptures, OfVelodyneGiveWhatCameBefore) {
  for (const char* name : {"sample_velodyne_hdl32.pcap", "sample_velodyne_vlp16_gps.pcap"}) {
    const std::string content = file_text(packets_ / "velodyne" / name);
    expect_sweeps_before_cuts(dir_, "cut.pcap", content, frames_of(content), make_velodyne_decoder);
  }
}

TEST_F(CutCaptures, OfNextGenerationGiveWhatCameBefore) {
  std::string content = test::pcapng_head();
  std::vector<Frame> frames;
  for (Frame frame : frames_of(file_text(packets_ / "velodyne/sample_velodyne_hdl32.pcap"))) {
    content += test::pcapng_packet(frame.bytes, static_cast<std::uint64_t>(frame.ns));
    frame.end = content.size();
    frames.push_back(std::move(frame));
  }
  expect_sweeps_before_cuts(dir_, "cut.pcapng", content, frames, make_velodyne_decoder);
}

/// The same datagrams in pieces, as networks carry packets of this size.
std::string in_pieces(const std::vector<Frame>& frames) {
  constexpr std::size_t headers = 14 + 20;
  constexpr std::size_t piece = 1480;
  std::string pcap = test::pcap({});
  std::uint16_t id = 0;
  for (const Frame& frame : frames) {
    const std::string datagram = frame.bytes.substr(headers);
    ++id;
    for (std::size_t at = 0; at < datagram.size(); at += piece) {
      const std::size_t more = at + piece < datagram.size() ? 0x2000 : 0;
      const std::string packet = test::ipv4(datagram.substr(at, piece), id, at / 8 + more);
      pcap += test::pcap_record(test::ethernet(packet), id * 100U);
    }
  }
  return pcap;
}

// A packet of which the last piece is cut off is not there.
TEST_F(CutCaptures, OfOusterGiveWhatCameBefore) {
  const fs::path json = packets_ / "ouster/OS-1-128_v2.3.0_1024x10.json";
  const std::string metadata = file_text(json);
  dir_.write("cut.json", metadata);
  const std::string recorded = file_text(packets_ / "ouster/OS-1-128_v2.3.0_1024x10_lb_n3.pcap");
  const std::string content = in_pieces(frames_of(recorded));
  expect_sweeps_before_cuts(dir_, "cut.pcap", content, frames_of(content), [&] {
    return make_ouster_decoder(read_ouster_metadata(metadata, json));
  });
}

}  // namespace
}  // namespace kissmap
