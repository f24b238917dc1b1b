// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <vector>

#include "formats/containers/container_file.hpp"
#include "formats/containers/datagrams.hpp"
#include "formats/containers/file_window.hpp"
#include "formats/containers/message_source.hpp"

namespace kissmap {

/// UDP datagrams of a pcap or pcapng file, in recorded order. Sources: the specifications of both
/// formats (IETF drafts draft-ietf-opsawg-pcap and -pcapng). Memory: one window of the file.
/// Not thread safe.
class PacketCapture {
 public:
  /// Throws Error(input) for what is no capture.
  explicit PacketCapture(const std::filesystem::path& path);

  /// False at the end, or where damage ends the capture.
  bool next(Datagram& datagram);

  /// Passes over what lies before the last `most_bytes` of the file, by looking there for frames
  /// that follow each other to its end; false where there are none. After the first next(), which
  /// tells about the frames.
  bool jump_near_end(std::uint64_t most_bytes);

  /// What ended the capture early; known after next() has returned false.
  const std::optional<ContainerDamage>& damage() const { return damage_; }
  const PassedOver& passed_over() const { return finder_.passed_over(); }
  LogFile log_file() const { return file_.log_file(); }

 private:
  struct Interface {
    std::uint32_t link_type = 1;
    std::uint64_t ticks_per_s = 1'000'000;
    std::int64_t offset_s = 0;
  };
  struct Frame {
    std::span<const std::byte> bytes;
    std::uint32_t link_type = 1;
    std::int64_t received_ns = 0;
    bool whole = true;
  };

  std::uint32_t u32(std::span<const std::byte> bytes, std::size_t at) const;
  std::uint16_t u16(std::span<const std::byte> bytes, std::size_t at) const;
  void begin_section(std::uint64_t offset);
  void add_interface(std::span<const std::byte> body);
  std::optional<Frame> next_pcap_frame();
  std::optional<Frame> next_block();
  std::optional<Frame> read_packet_block(std::uint32_t type, std::span<const std::byte> body);
  const Interface& interface(std::uint32_t number) const;
  std::uint64_t frame_size(std::span<const std::byte> bytes, std::size_t at) const;
  bool frames_follow(std::span<const std::byte> bytes, std::size_t at) const;

  ContainerFile file_;
  FileWindow window_;
  std::uint64_t offset_ = 0;
  std::int64_t last_ns_ = 0;      ///< when the last frame was received
  bool next_generation_ = false;  ///< pcapng
  bool swap_ = false;
  bool nanoseconds_ = false;
  bool ended_ = false;
  std::vector<Interface> interfaces_;
  DatagramFinder finder_;
  std::optional<ContainerDamage> damage_;
};

}  // namespace kissmap
