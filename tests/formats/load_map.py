"""Loads a map as map servers do, from their rules alone, and prints its cells.

usage: load_map.py MAP.yaml ros1|nav2

First line: width height resolution x y yaw; then a row of -1 and 0..100 for each row of cells, lowest y
first. Rules: ROS 1 map_server image_loader.cpp and nav2_map_server map_io.cpp.
"""
import os
import sys

import yaml
from PIL import Image


def ros1(pixel, channels, p):
    mode = p.get("mode", "trinary")
    used = pixel if mode == "trinary" or channels in (1, 3) else pixel[:-1]
    alpha = 255 if channels in (1, 3) else pixel[-1]
    average = sum(used) / len(used)
    if p["negate"]:
        average = 255 - average
    occupied = (255 - average) / 255
    if occupied > p["occupied_thresh"]:
        return 100
    if occupied < p["free_thresh"]:
        return 0
    if mode == "trinary" or alpha < 255:
        return -1
    ratio = (occupied - p["free_thresh"]) / (p["occupied_thresh"] - p["free_thresh"])
    return int(1 + 98 * ratio)


def nav2(pixel, channels, p):
    mode = p.get("mode", "trinary")
    colours = pixel[:-1] if channels in (2, 4) else pixel
    alpha = pixel[-1] if channels in (2, 4) else 255
    shade = sum(colours) / len(colours) / 255
    occupied = shade if p["negate"] else 1 - shade
    if mode == "trinary":
        if occupied >= p["occupied_thresh"]:
            return 100
        return 0 if occupied <= p["free_thresh"] else -1
    if alpha < 255:
        return -1
    if occupied >= p["occupied_thresh"]:
        return 100
    if occupied <= p["free_thresh"]:
        return 0
    return round(100 * (occupied - p["free_thresh"]) / (p["occupied_thresh"] - p["free_thresh"]))


def main():
    path, loader = sys.argv[1], {"ros1": ros1, "nav2": nav2}[sys.argv[2]]
    with open(path) as file:
        p = yaml.safe_load(file)
    for key in ("image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh"):
        if key not in p:
            sys.exit("no " + key)
    if not isinstance(p["origin"], list) or len(p["origin"]) != 3 or not isinstance(p["negate"], int):
        sys.exit("origin or negate")
    if not all(isinstance(v, (int, float)) for v in [p["resolution"], *p["origin"]]):
        sys.exit("not a number")
    image = Image.open(os.path.join(os.path.dirname(os.path.abspath(path)), p["image"]))
    channels = len(image.getbands())
    print(image.width, image.height, repr(p["resolution"]), *map(repr, p["origin"]))
    pixels = list(image.getdata())
    for row in reversed(range(image.height)):
        line = pixels[row * image.width:(row + 1) * image.width]
        print(*(loader(v if isinstance(v, tuple) else (v,), channels, p) for v in line))


main()
