"""Reads layers of a map of paperbake and keeps of them what the material needs, as a plain picture that every engine of Blender loads."""

import struct
import zlib

import bpy
import numpy

ZIP, BLOCK = 3, 16  # EXR's number for zlib, and lines that are packed as one
KINDS = {0: numpy.dtype("<u4"), 1: numpy.dtype("<f2"), 2: numpy.dtype("<f4")}


class Unreadable(Exception):
    """No map of scan lines as paperbake writes it."""


def text(data, at):
    end = data.index(b"\0", at)
    return data[at:end].decode(), end + 1


def header(data):
    """Attributes of an EXR header as {name: bytes}, and where the table of offsets begins."""
    if struct.unpack_from("<II", data) != (20000630, 2):
        raise Unreadable("it is no EXR file of scan lines")
    attributes, at = {}, 8
    while data[at]:
        name, at = text(data, at)
        _, at = text(data, at)
        size = struct.unpack_from("<I", data, at)[0]
        attributes[name] = data[at + 4:at + 4 + size]
        at += 4 + size
    return attributes, at + 1


def channels(listed):
    """[(name, dtype)] in the order of the lines."""
    found, at = [], 0
    while listed[at]:
        name, at = text(listed, at)
        found.append((name, KINDS[struct.unpack_from("<I", listed, at)[0]]))
        at += 16
    return found


def unzipped(packed, size):
    """Bytes of a block: zlib, then the predictor and the two halves that EXR puts on top."""
    if len(packed) == size:
        return packed
    bytes_ = numpy.frombuffer(zlib.decompress(packed), dtype=numpy.uint8)
    sums = (numpy.cumsum(bytes_, dtype=numpy.int64) - 128 * numpy.arange(len(bytes_))).astype(numpy.uint8)
    plain, half = numpy.empty_like(sums), (len(sums) + 1) // 2
    plain[0::2], plain[1::2] = sums[:half], sums[half:]
    return plain.tobytes()


def layers(path, wanted):
    """{name: HxW float32, the top row first} of the wanted layers. Throws Unreadable, OSError."""
    with open(path, "rb") as file:
        data = file.read()
    try:
        attributes, table = header(data)
        x0, y0, x1, y1 = struct.unpack("<4i", attributes["dataWindow"])
        width, height, listed = x1 - x0 + 1, y1 - y0 + 1, channels(attributes["channels"])
        if attributes["compression"][0] != ZIP:
            raise Unreadable("it is not packed with zlib")
        found = {name: numpy.empty((height, width), dtype=numpy.float32) for name in wanted}
        for offset in struct.unpack_from(f"<{-(-height // BLOCK)}Q", data, table):
            y, size = struct.unpack_from("<iI", data, offset)
            lines = range(y - y0, min(y - y0 + BLOCK, height))
            block = unzipped(data[offset + 8:offset + 8 + size], len(lines) * width * sum(kind.itemsize for _, kind in listed))
            at = 0
            for line in lines:
                for name, kind in listed:
                    if name in found:
                        found[name][line] = numpy.frombuffer(block, dtype=kind, count=width, offset=at)
                    at += width * kind.itemsize
    except (KeyError, ValueError, IndexError, struct.error, zlib.error) as error:
        raise Unreadable(f"it is damaged ({error})") from error
    return found


def crease_picture(path, target):
    """Image for the material, saved beside the map: R = crease strength so far, signed: > 0 where the sheet bulges to its normal;
    G = s since the crease appeared; B = singular points. Throws Unreadable, OSError, RuntimeError."""
    read = layers(path, ("R", "G", "fold.peak", "age.crease"))
    height, width = read["R"].shape
    pixels = numpy.ones((height, width, 4), dtype=numpy.float32)
    pixels[..., 0] = read["R"] * numpy.where(read["fold.peak"] < 0, -1, 1)
    pixels[..., 1] = numpy.maximum(read["age.crease"], 0)
    pixels[..., 2] = read["G"]
    image = bpy.data.images.new("paperbake", width, height, alpha=False, float_buffer=True, is_data=True)
    image.pixels.foreach_set(pixels[::-1].ravel())
    image.filepath_raw, image.file_format = target, "OPEN_EXR"
    image.save()
    bpy.data.images.remove(image)
    return target
