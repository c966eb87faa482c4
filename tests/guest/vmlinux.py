#!/usr/bin/env python3
"""vmlinux.py VMLINUZ OUT: the kernel itself out of its compressed image, so that the emulated machine need not
unpack it. What is compressed in another way than Debian's is copied as it is, which only starts later.

The places of the fields are those of the kernel's "The Linux/x86 Boot Protocol", "The Real-Mode Kernel Header".
"""

import lzma
import struct
import sys

SECTOR = 512
SETUP_SECTORS = 0x1F1
PAYLOAD_OFFSET = 0x248


def unpacked(image: bytes) -> bytes:
    offset, length = struct.unpack_from("<II", image, PAYLOAD_OFFSET)
    # No number of sectors means four; the boot sector comes before them.
    begin = ((image[SETUP_SECTORS] or 4) + 1) * SECTOR + offset
    try:
        # Four bytes of length follow the stream.
        return lzma.LZMADecompressor().decompress(image[begin : begin + length])
    except lzma.LZMAError:
        return image


def main() -> None:
    source, target = sys.argv[1:]
    with open(source, "rb") as file:
        image = file.read()
    with open(target, "wb") as file:
        file.write(unpacked(image))


main()
