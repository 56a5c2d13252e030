#!/usr/bin/env python3
"""Paints an unpacked asset: a disc of raised, orange surface on every patch, as one would in Krita.

    gtx unpack model.gtx maps
    samples/paint_maps.py maps
    gtx pack maps -o painted.gtx --rebuild mips,normals --lod-levels 5

Only level 0 of the colour and height maps is painted; `--rebuild` makes the rest. With the standard
library alone: 20 lines read and write the PNGs that gtx writes (8 bits, no interlacing).
"""
import json
import pathlib
import struct
import sys
import zlib

CHANNELS = {0: 1, 2: 3, 6: 4}  # by PNG's colour types


def read_png(path):
    data, at, packed = path.read_bytes(), 8, b""
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + size]
        if kind == b"IHDR":
            width, height, bits, color = struct.unpack(">IIBB", body[:10])
        elif kind == b"IDAT":
            packed += body
        at += size + 12
    if bits != 8:
        sys.exit(f"{path}: this sample paints maps of 8 bits")
    step, lines, out = CHANNELS[color], zlib.decompress(packed), []
    stride, before = width * step, bytearray(width * step)
    for y in range(height):
        kind, line = lines[y * (stride + 1)], bytearray(lines[y * (stride + 1) + 1:][:stride])
        for x in range(stride):  # the filters of the specification, 9.2
            a = line[x - step] if x >= step else 0
            b, c = before[x], before[x - step] if x >= step else 0
            pa, pb, pc = abs(b - c), abs(a - c), abs(a + b - 2 * c)
            paeth = a if pa <= pb and pa <= pc else b if pb <= pc else c
            line[x] = (line[x] + (0, a, b, (a + b) // 2, paeth)[kind]) & 255
        out.append(line)
        before = line
    return out, step, color


def write_png(path, rows, step, color):
    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
    head = struct.pack(">IIBBBBB", len(rows[0]) // step, len(rows), 8, color, 0, 0, 0)
    body = zlib.compress(b"".join(b"\0" + bytes(row) for row in rows))
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", body) +
                     chunk(b"IEND", b""))


def main():
    folder = pathlib.Path(sys.argv[1])
    about = json.loads((folder / "asset.json").read_text())
    for page in range(about["page_count"]):
        height, _, gray = read_png(folder / f"height-{page}.png")
        color_file = folder / f"color-{page}-0.png"
        color, step, kind = read_png(color_file) if about["has_color"] else (None, 4, 6)
        for patch in about["patches"]:
            if patch["page"] != page:
                continue
            x0, y0, w, h = patch["rect"]
            radius = min(w, h) / 4
            for y in range(y0, y0 + h):
                for x in range(x0, x0 + w):
                    away = ((x - x0 - w / 2) ** 2 + (y - y0 - h / 2) ** 2) ** 0.5
                    if away >= radius or height[y][x] == 0:  # 0 is no surface: it stays none
                        continue
                    height[y][x] = min(255, height[y][x] + int(40 * (1 - away / radius)))
                    if color:
                        color[y][x * step:x * step + 3] = bytes((255, 128, 0))
        write_png(folder / f"height-{page}.png", height, 1, gray)
        if color:
            write_png(color_file, color, step, kind)


main()
