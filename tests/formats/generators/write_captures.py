# SPDX-License-Identifier: MIT
"""VLP-16 packets in UDP, whole and in fragments, as pcap and pcapng: write_captures.py FOLDER."""
import struct
import sys

import numpy as np

from truth import Truth

START_NS = 1_700_000_000_000_000_000  # 800 s after a full hour
PAST_HOUR_US = 800_000_000
FIRING_US = 110.592  # two firings of sixteen shots make a block
STEP = 40  # hundredths of a degree a block
PACKETS = 180  # two turns are 150
ELEVATION = [-15, 1, -13, 3, -11, 5, -9, 7, -7, 9, -5, 11, -3, 13, -1, 15]
SHOTS = {0: 5000, 1: 5010, 17: 2500, 30: 40000}  # shot of a block: distance in steps of 2 mm


def distance(block, shot):
    """0 where nothing is met; besides SHOTS, each block has one more, so that all lasers have their turn."""
    return SHOTS.get(shot, 3000 + 100 * shot if block % 32 == shot else 0)


def packet(index):
    """Twelve blocks with a few returns each; their points and times, too."""
    stamp_us = PAST_HOUR_US + round(index * 12 * FIRING_US)
    data, seen = b"", []
    for block in range(12):
        azimuth = STEP * (12 * index + block) % 36000
        data += struct.pack("<HH", 0xEEFF, azimuth)
        for shot in range(32):
            steps = distance(12 * index + block, shot)
            data += struct.pack("<HB", steps, 10 + shot if steps else 0)
            if steps:
                since_block = 55.296 * (shot // 16) + 2.304 * (shot % 16)
                turned = np.radians((azimuth + STEP * since_block / FIRING_US) / 100)
                up = np.radians(ELEVATION[shot % 16])
                flat = steps * 0.002 * np.cos(up)
                time = (stamp_us - PAST_HOUR_US + block * FIRING_US + since_block) * 1e-6
                seen.append((flat * np.cos(turned), -flat * np.sin(turned), steps * 0.002 * np.sin(up),
                             10 + shot, time))
    return data + struct.pack("<IBB", stamp_us, 0x37, 0x22), seen


def ipv4(identity, payload, offset=0, more=False):
    head = struct.pack(">BBHHHBBH4s4s", 0x45, 0, 20 + len(payload), identity, (0x2000 if more else 0) | offset // 8,
                       64, 17, 0, bytes([192, 168, 1, 201]), bytes([192, 168, 1, 77]))
    total = sum(struct.unpack(">10H", head))
    total = (total & 0xFFFF) + (total >> 16)
    return head[:10] + struct.pack(">H", ~total & 0xFFFF) + head[12:] + payload


def ethernet(datagram, tagged):
    tag = struct.pack(">HH", 0x8100, 42) if tagged else b""
    return b"\xff" * 6 + bytes([0x60, 0x76, 0x88, 0, 0, 1]) + tag + b"\x08\x00" + datagram


def udp(payload):
    return struct.pack(">HHHH", 2368, 2368, 8 + len(payload), 0) + payload


def frames(index, payload, fragmented, tagged):
    """One frame, or three fragments, which arrive in another order in every second packet."""
    whole = udp(payload)
    if not fragmented:
        return [ethernet(ipv4(index, whole), tagged)]
    cuts = [(0, 480), (480, 960), (960, len(whole))]
    parts = [ethernet(ipv4(index, whole[a:b], a, b < len(whole)), tagged) for a, b in cuts]
    return parts if index % 2 == 0 else [parts[2], parts[0], parts[1]]


def pcap(rows, ns, order="<"):
    out = struct.pack(order + "IHHiIII", 0xA1B23C4D if ns else 0xA1B2C3D4, 2, 4, 0, 0, 65535, 1)
    for time, data in rows:
        part = time % 10**9 // (1 if ns else 1000)
        out += struct.pack(order + "IIII", time // 10**9, part, len(data), len(data)) + data
    return out


def block(kind, body):
    body += b"\0" * (-len(body) % 4)
    size = struct.pack("<I", 12 + len(body))
    return struct.pack("<I", kind) + size + body + size


def pcapng(rows):
    """Stamps in nanoseconds, which the interface's option 9 says; a block of names that is none of ours."""
    out = block(0x0A0D0D0A, struct.pack("<IHHq", 0x1A2B3C4D, 1, 0, -1))
    out += block(1, struct.pack("<HHI", 1, 0, 0) + struct.pack("<HHB3xHH", 9, 1, 9, 0, 0))
    out += block(4, struct.pack("<HH", 0, 0))
    for time, data in rows:
        out += block(6, struct.pack("<IIIII", 0, time >> 32, time & 0xFFFFFFFF, len(data), len(data)) + data)
    return out


def write(truth, name, wrap, fragmented, tagged, lost=()):
    rows, seen = [], []
    for index in range(PACKETS):
        payload, returns = packet(index)
        time = START_NS + round(index * 12 * FIRING_US * 1000) + 1_327_104  # when its last shot was fired
        parts = frames(index + 1, payload, fragmented, tagged)
        if index in lost:
            del parts[1]  # without its part, nothing of a packet is to be believed
        else:
            seen += returns
        rows += [(time + 1000 * i, data) for i, data in enumerate(parts)]
    truth.bytes(name, wrap(rows))
    truth.log(name, "pcap")
    table = np.array(seen)
    truth.stream(START_NS, "start|end|unknown", "no", "recorded", table[:, :3], table[:, 3], table[:, 4])


truth = Truth(sys.argv[1])
write(truth, "whole.pcap", lambda rows: pcap(rows, False), False, False)
write(truth, "big_endian_ns.pcap", lambda rows: pcap(rows, True, ">"), False, True)
write(truth, "fragments.pcap", lambda rows: pcap(rows, True), True, True)
write(truth, "fragments.pcapng", pcapng, True, False)
write(truth, "lost_fragment.pcapng", pcapng, True, True, lost=(40, 97))
