"""Changes of a file's bytes, of its text, of XML and of miniSEED: each a function (data, random, others) -> data.

`others` are the undamaged files of the same kind.  Every function takes any bytes, so that changes can follow another.
"""

import re

NUMBER = re.compile(rb"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
NUMBERS = (b"nan", b"inf", b"-inf", b"1e308", b"-1", b"0", b"", b"1e-320", b"9" * 400, b"9" * 5000, b"2147483648",
           b"18446744073709551616", b"1e5", b"0.1.2", b"1_000", b"0x10", b"-0.0", b"1e400", b"true", b"word",
           "\u0663".encode(), b"\x1b[31m", b"1000000", b'"1"')
WORDS = (0, 1, 2, 0x7F, 0x80, 0xFF, 0x7FFF, 0x8000, 0xFFFF, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF)
ENCODINGS = ("utf-16", "utf-16-be", "utf-32", "utf-8-sig", "utf-7", "cp037", "latin-1")
LONGEST = 400_000  # bytes of a part that is put in by the thousand


def mutate(data, random, others, kinds, largest=10**6):
    """(data after one to three changes of `kinds`, what they are); one file in sixty grows to as many as `largest`
    bytes."""
    done = []
    for change in random.choices(kinds, k=random.choice((1, 1, 1, 2, 3))):
        data = change(data, random, others)
        done.append(change.__name__)
    if random.random() < 1 / 60:
        data = swell(data, random, int(largest * 10 ** random.uniform(-2, 0.05)))
        done.append(f"swell to {len(data)} bytes")
    return data, ", ".join(done)


def _stretch(data, random):
    """The two ends of a part, mostly a short one."""
    start = random.randrange(len(data) + 1)
    return start, min(len(data), start + int(2 ** random.uniform(0, 12)))


# --- bytes ----------------------------------------------------------------------------------------

def bits(data, random, others):
    data = bytearray(data)
    for _ in range(random.choice((1, 1, 2, 30)) if data else 0):
        data[random.randrange(len(data))] ^= 1 << random.randrange(8)
    return bytes(data)


def some_bytes(data, random, others):
    start, _ = _stretch(data, random)
    new = random.randbytes(random.choice((1, 2, 4, 100)))
    return data[:start] + new + data[start + len(new):]


def insert(data, random, others):
    start, _ = _stretch(data, random)
    return data[:start] + random.choice((b"\0", b"\xff", b"\n", b",", b'"', b"\0" * 1000, random.randbytes(20))) \
        + data[start:]


def delete(data, random, others):
    start, end = _stretch(data, random)
    return data[:start] + data[end:]


def duplicate(data, random, others):
    start, end = _stretch(data, random)
    return data[:end] + data[start:end] * random.choice((1, 1, 2, 50)) + data[end:]


def blank(data, random, others):
    start, end = _stretch(data, random)
    return data[:start] + random.choice((b"\0", b"\xff", b" ")) * (end - start) + data[end:]


def truncate(data, random, others):
    return data[:random.choice((0, 1, random.randrange(len(data) + 1), random.randrange(len(data) + 1)))]


def splice(data, random, others):
    other = random.choice(others)
    return data[:random.randrange(len(data) + 1)] + other[random.randrange(len(other) + 1):]


BYTES = (bits, bits, some_bytes, insert, delete, duplicate, blank, truncate, splice)


def swell(data, random, size):
    """A file of so many bytes: of a line, a cell, a character, of all of it."""
    lines = data.splitlines(keepends=True) or [b""]
    start, end = _stretch(data, random)
    unit = random.choice((random.choice(lines), data, data[start:end], b"\n", b",", b"[", b"1 ", b"0,0\n", b"\0",
                          b"#\n", b"a,", b'"', b" ")) or b"0"
    return (random.choice((data, data[:end], b"")) + unit * (size // len(unit) + 1))[:size]


# --- text -----------------------------------------------------------------------------------------

def number(data, random, others):
    return _replaced(data, random, NUMBER, random.choice(NUMBERS))


def cell(data, random, others):
    new = random.choice((*NUMBERS, b"a,b", b"#", b'"', b" ", b"=", b"["))
    return _replaced(data, random, re.compile(rb"[^,\s]+"), new)


def _replaced(data, random, pattern, new):
    found = list(pattern.finditer(data[:LONGEST]))
    if not found:
        return data + new
    here = random.choice(found)
    return data[:here.start()] + new + data[here.end():]


def lines(data, random, others):
    """Lines swapped, repeated, left out, turned round, or without their ends."""
    found = data.split(b"\n")
    here, there = random.randrange(len(found)), random.randrange(len(found))
    what = random.randrange(5)
    if what == 0:
        found[here], found[there] = found[there], found[here]
    elif what == 1:
        found[there:there] = [found[here]] * random.choice((1, 1, 3, 1000))
    elif what == 2:
        del found[min(here, there):max(here, there)]
    elif what == 3:
        found.reverse()
    else:
        return b"".join(found)
    return b"\n".join(found)


def columns(data, random, others):
    """A column left out, repeated, or empty, or other marks between them."""
    rows = [row.split(b",") for row in data.split(b"\n")]
    here, what = random.randrange(max(map(len, rows))), random.randrange(4)
    if what == 3:
        return data.replace(b",", random.choice((b";", b"\t", b",,", b" ")))
    new = (lambda cells: [], lambda cells: cells * 2, lambda cells: [b""] * len(cells))[what]
    return b"\n".join(b",".join(row[:here] + new(row[here:here + 1]) + row[here + 1:]) for row in rows)


def encoding(data, random, others):
    text = data.decode("utf-8", errors="replace")
    return text.encode(random.choice(ENCODINGS), errors="replace")


def line_ends(data, random, others):
    return data.replace(b"\n", random.choice((b"\r\n", b"\r", b"\n\n", b"\0", "\u2028".encode(), b"\x0b", b"\x0c")))


def long_line(data, random, others):
    found = data.split(b"\n")
    here = random.randrange(len(found))
    found[here] = (found[here] or b"x") * (LONGEST // max(1, len(found[here])))
    return b"\n".join(found)


def nest(data, random, others):
    """Deeper than any program follows."""
    start, _ = _stretch(data, random)
    depth = random.choice((10, 500, 20_000))
    opening, closing = random.choice(((b"[", b"]"), (b"{a=", b"}"), (b"(", b")"), (b'"""', b""), (b"a.", b"b"),
                                      (b"<a>", b"</a>")))
    return data[:start] + opening * depth + closing * depth + data[start:]


TEXT = (*BYTES, number, number, number, number, cell, cell, lines, lines, columns, encoding, line_ends, long_line, nest)


# --- XML ------------------------------------------------------------------------------------------

_ELEMENT = re.compile(rb"<([A-Za-z]+)[^<>]*>([^<>]*)</\1>")
_TAG = re.compile(rb"</?[A-Za-z][^<>]*>")
_LAUGHS = b"".join(b'<!ENTITY l%d "%s">' % (k, b"&l%d;" % (k - 1) * 10) for k in range(1, 10))
DOCTYPES = (
    b'<!DOCTYPE x [<!ENTITY l0 "ha">' + _LAUGHS + b"]>",
    b'<!DOCTYPE x [<!ENTITY l9 "' + b"a" * 50_000 + b'">]>',
    b'<!DOCTYPE x [<!ENTITY l9 SYSTEM "file:///etc/hostname">]>',
    b'<!DOCTYPE x [<!ENTITY l9 SYSTEM "/dev/zero">]>',
    b'<!DOCTYPE x [<!ENTITY l9 "&l9;">]>',
    b'<!DOCTYPE x [<!ENTITY % p SYSTEM "file:///etc/hostname"> %p;]>',
    b'<!DOCTYPE x SYSTEM "/dev/zero">',
)
"""Entities that grow a thousand million times, that are long and used often, that are other files, or themselves."""


def entities(data, random, others):
    """A document type with entities, one of them in the place of an element's text."""
    start = max(data.find(b"?>") + 2, 0) if data.startswith(b"<?xml") else 0
    body = _replaced_text(data[start:], random, random.choice((b"&l9;", b"&l9;" * 1000)))
    return data[:start] + random.choice(DOCTYPES) + body


def element(data, random, others):
    """An element's text made another, or the element left out, repeated, or put elsewhere."""
    found = list(_ELEMENT.finditer(data))
    if not found:
        return data
    here, there = random.choice(found), random.choice(found)
    what = random.randrange(4)
    if what == 0:
        return _replaced_text(data, random, random.choice((*NUMBERS, b"M/S", b"2018-01-08", b"9999-99-99T99:99:99")))
    new = (here[0] * 2, b"", there[0])[what - 1]
    return data[:here.start()] + new + data[here.end():]


def _replaced_text(data, random, new):
    found = list(_ELEMENT.finditer(data))
    if not found:
        return data + new
    here = random.choice(found)
    return data[:here.start(2)] + new + data[here.end(2):]


def tag(data, random, others):
    news = b"", b"<a>", b"<a/>", b"</a>", b"<!--", b"<![CDATA[", b"<a b='1' b='1'"
    return _replaced(data, random, _TAG, random.choice(news))


def deep(data, random, others):
    depth = random.choice((100, 300, 100_000))
    return _replaced_text(data, random, b"<Comment>" * depth + b"</Comment>" * random.choice((depth, 0)))


XML = (*BYTES, number, number, lines, encoding, long_line, entities, entities, element, element, element, tag, tag,
       deep)


# --- miniSEED -------------------------------------------------------------------------------------

RECORD = 512  # bytes of a record in the files that ship


def field(data, random, others):
    """A number in a record's head: of samples, rate, offsets, blockettes, encoding, length of the record."""
    size = random.choice((1, 2, 4))
    value = random.choice(WORDS) % 256**size
    start = random.randrange(len(data) // RECORD + 1) * RECORD + random.randrange(64)
    return data[:start] + value.to_bytes(size, "big") + data[start + size:]


def same_field(data, random, others):
    """The same of every record, as of another instrument."""
    size, within = random.choice((1, 2, 4)), random.randrange(20, 64)
    value = (random.choice(WORDS) % 256**size).to_bytes(size, "big")
    parts = (data[k:k + RECORD] for k in range(0, len(data), RECORD))
    return b"".join(part[:within] + value + part[within + size:] for part in parts)


def records(data, random, others):
    """Records swapped, repeated, left out, or of another component."""
    parts = [data[k:k + RECORD] for k in range(0, len(data), RECORD)] or [b""]
    here, there, what = random.randrange(len(parts)), random.randrange(len(parts)), random.randrange(4)
    if what == 0:
        parts[here], parts[there] = parts[there], parts[here]
    elif what == 1:
        parts[there:there] = [parts[here]] * random.choice((1, 1, 200))
    elif what == 2:
        del parts[here]
    else:
        parts[here] = random.choice(others)[:RECORD]
    return b"".join(parts)


MINISEED = (*BYTES, field, field, field, same_field, same_field, same_field, records)
