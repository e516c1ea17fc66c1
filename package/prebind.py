"""Binds the references of a library to its own functions and classes, so that the loader need not."""

import struct

SECTION = struct.Struct("<IIQQQQIIQQ")  # name, type, flags, address, place, bytes, link, ...
RELOCATION = struct.Struct("<QQq")  # where, type and symbol, addend
SYMBOL = struct.Struct("<IBBHQQ")  # name, binding and type, visibility, section, address, size
SYMBOLS, RELOCATIONS = 11, 4  # types of sections
ABSOLUTE, IN_TABLE, CALL, RELATIVE = 1, 6, 7, 8  # types of relocations of x86-64
FUNCTION, OBJECT, UNIQUE = 2, 1, 10  # types and a binding of symbols
CLASSES = (b"_ZTV", b"_ZTI", b"_ZTS")  # tables of virtual functions, types and their names


def prebind(file):
    """Rewrites a library of ELF for x86-64, in place, and returns how many references were bound.

    The loader looks each name up in all libraries, in case that another one has it before. That takes
    three quarters of a start, since Debian links libopenvdb so that all is looked up at once. Data
    keep their lookup: there must be one of each. Functions and classes are the same everywhere.
    """
    content = bytearray(file.read_bytes())
    (place,) = struct.unpack_from("<Q", content, 0x28)
    size, count = struct.unpack_from("<HH", content, 0x3A)
    sections = [SECTION.unpack_from(content, place + i * size) for i in range(count)]
    table = next(section for section in sections if section[1] == SYMBOLS)
    symbols, names = table[4], sections[table[6]][4]

    def is_own(symbol):
        name, kind, _, section, _, _ = symbol
        if section == 0 or kind >> 4 == UNIQUE:
            return False
        first = content[names + name : names + name + 4]
        return kind & 15 == FUNCTION or (kind & 15 == OBJECT and first in CLASSES)

    bound = 0
    for section in (section for section in sections if section[1] == RELOCATIONS):
        for at in range(section[4], section[4] + section[5], RELOCATION.size):
            where, info, addend = RELOCATION.unpack_from(content, at)
            kind, symbol = info & 0xFFFFFFFF, SYMBOL.unpack_from(content, symbols + (info >> 32) * SYMBOL.size)
            if kind in (ABSOLUTE, IN_TABLE, CALL) and is_own(symbol):
                target = symbol[4] + (addend if kind == ABSOLUTE else 0)
                RELOCATION.pack_into(content, at, where, RELATIVE, target)
                bound += 1
    file.write_bytes(content)
    return bound
