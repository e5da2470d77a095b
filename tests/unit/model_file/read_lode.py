#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""A reader of .lode files written from docs/FILE_FORMAT.md alone, to show that the page is enough.

    read_lode.py MODEL.lode OUT

Replays all records and writes, for every face slot in order, nine floats (three positions), the bits of three normals,
uvs and colours where there are any, and the feature, as a stranger would need them. Plain and slow on purpose.
"""
import ctypes
import ctypes.util
import math
import struct
import sys

NONE = 0xFFFFFFFF
MASK = 0xFFFFFFFF
(SUMMARY, ERROR_LEVEL, ERROR_BITS, KIND, SPLIT, RING) = range(6)
(RING_WIDE, CORNER, MATERIAL, FEATURE, NEW, MOVED, EDIT) = (13, 14, 15, 16, 17, 26, 35)
(COUNT, MERGE, GROUP, FACE, EDIT_CORNER, TO, EDIT_MOVED, ESCAPE, SAME) = range(44, 53)


def unpack(data, raw_size):
    zstd = ctypes.CDLL(ctypes.util.find_library("zstd") or "libzstd.so.1")
    zstd.ZSTD_decompress.restype = ctypes.c_size_t
    out = ctypes.create_string_buffer(raw_size)
    size = zstd.ZSTD_decompress(out, ctypes.c_size_t(raw_size), data, ctypes.c_size_t(len(data)))
    assert size == raw_size
    return out.raw


def unzigzag(z):
    return (z >> 1) ^ (MASK if z & 1 else 0)


def signed(word):
    return word - (1 << 32) if word >> 31 else word


class Fields:
    def __init__(self, data):
        self.data, self.at = data, 0

    def get(self, form):
        values = struct.unpack_from("<" + form, self.data, self.at)
        self.at += struct.calcsize("<" + form)
        return values[0] if len(values) == 1 else values

    def string(self):
        size = self.get("I")
        self.at += size
        return self.data[self.at - size:self.at].decode()

    def list(self, read):
        return [read() for _ in range(self.get("I"))]


class Column:
    def __init__(self, tokens, extra):
        self.tokens, self.at = tokens, 0
        self.bits, self.bit = int.from_bytes(extra, "little"), 0

    def get(self):
        token = self.tokens[self.at]
        self.at += 1
        if token < 64:
            return token
        e = 6 + (token - 64) // 2
        extra = (self.bits >> self.bit) & ((1 << (e - 1)) - 1)
        self.bit += e - 1
        return ((2 + token % 2) << (e - 1)) + extra


def columns_of(raw):
    table = struct.unpack_from("<106I", raw)
    columns, at = [], 424
    for i in range(53):
        tokens, extra = table[2 * i], table[2 * i + 1]
        columns.append(Column(raw[at:at + tokens], raw[at + tokens:at + tokens + extra]))
        at += tokens + extra
    assert at == len(raw)
    return columns


class Guess:
    def __init__(self, p, d, t, color, words):
        self.p, self.d, self.t, self.color, self.words = p, d, t, color, words
        self.across = [0.0, 0.0, 0.0]


class Model:
    def __init__(self, data):
        assert data[:8] == b"\x89LODE\r\n\x1a"
        version, stored, raw, packed = struct.unpack_from("<4I", data, 8)
        assert version == 1
        head = data[32:32 + stored]
        self.read_header(Fields(unpack(head, raw) if packed else head))
        blocks, at = [], 32 + stored
        for kind, packed, count, stored, raw, _ in self.blocks:
            block = data[at:at + stored]
            at += stored
            if kind < 2:
                blocks.append((count, columns_of(unpack(block, raw) if packed else block)))
        summaries = [self.read_summary(columns) for _, columns in blocks]
        self.faces_of = [sum(s[2].get(m, 0) for s in summaries) for m in range(self.materials)]
        self.next_face = [sum(self.faces_of[:m]) for m in range(self.materials)]
        self.first_face = list(self.next_face)
        faces = sum(self.faces_of)
        self.corner_vertex = [NONE] * (3 * faces)
        self.face_feature = [NONE] * faces
        self.lists, self.values, self.errors = [], [], []
        self.split = self.vertex = self.corner = self.material = self.feature = 0
        self.level = self.bits = 0
        for i, (count, columns) in enumerate(blocks):
            self.c = columns
            if i == 0:
                self.base(summaries[0])
            for _ in range(count):
                self.record()
            for _ in range(summaries[i][1]):
                self.level += columns[ERROR_LEVEL].get()
                self.bits = (self.bits - columns[ERROR_BITS].get()) & MASK
                self.errors.append((self.level, struct.unpack("<f", struct.pack("<I", self.bits))[0]))
            assert all(column.at == len(column.tokens) for column in columns)

    def read_header(self, f):
        f.get("B")
        f.string()
        self.origin = f.get("3d")
        f.string(), f.string()
        self.normals, self.uvs, self.colors, self.features = f.get("4B")
        self.grid_bits = f.get("I")
        self.grid_corner, self.grid_step = f.get("3d"), f.get("d")
        self.normal_bits, self.uv_step = f.get("I"), f.get("d")
        f.get("3I")
        self.materials = len(f.list(lambda: (f.string(), f.get("4fIfB"))))
        f.list(lambda: (f.string(), f.string(), f.string()))
        f.list(lambda: (f.string(), f.string(), f.get("I")))
        f.list(lambda: (f.string(), f.get("I")))
        self.blocks = f.list(lambda: f.get("BBIQQQ"))
        self.normal_words = (2 if self.grid_bits else 3) if self.normals else 0
        self.uv_at = 3 + self.normal_words
        self.color_at = self.uv_at + (2 if self.uvs else 0)
        self.words = self.color_at + (1 if self.colors else 0)

    @staticmethod
    def read_summary(columns):
        c = columns[SUMMARY]
        vertices, steps, materials = c.get(), c.get(), c.get()
        return vertices, steps, {c.get(): c.get() for _ in range(materials)}

    # Lists and faces

    def append(self, vertex, corner):
        self.corner_vertex[corner] = vertex
        if self.lists[vertex] is not None:
            self.lists[vertex].append(corner)
            if len(self.lists[vertex]) > 250:
                self.lists[vertex] = None

    def remove(self, vertex, corner):
        if self.lists[vertex] is not None:
            self.lists[vertex].remove(corner)

    def add_face(self, material, *vertices):
        face = self.next_face[material]
        self.next_face[material] += 1
        for i, vertex in enumerate(vertices):
            self.append(vertex, 3 * face + i)
        return face

    def add_vertices(self, count):
        self.lists += [[] for _ in range(count)]
        self.values += [[0] * self.words for _ in range(count)]

    def after(self, corner):
        return self.corner_vertex[corner - 2 if corner % 3 == 2 else corner + 1]

    def before(self, corner):
        return self.corner_vertex[corner + 2 if corner % 3 == 0 else corner - 1]

    def material_of(self, corner):
        return max(m for m in range(self.materials) if self.faces_of[m] and self.first_face[m] <= corner // 3)

    def difference(self, column, to):
        return (to + unzigzag(self.c[column].get())) & MASK

    def code_feature(self, face, expected):
        if self.features:
            self.feature = self.face_feature[face] = self.difference(FEATURE, expected)

    # Values

    def number(self, word):
        return float(signed(word)) if self.grid_bits else struct.unpack("<f", struct.pack("<I", word))[0]

    def like(self, u):
        w = self.values[u]
        d = [self.number(x) for x in w[3:6]] if self.normal_words == 3 else [0.0] * 3
        t = [self.number(x) for x in w[self.uv_at:self.uv_at + 2]] if self.uvs else [0.0] * 2
        return Guess([self.number(x) for x in w[:3]], d, t, w[self.color_at] if self.colors else 0, w[3:5])

    def inside(self, ring):
        guess = self.like(ring[0])
        start, before = list(guess.p), [0.0] * 3
        for u in ring[1:]:
            g = self.like(u)
            b = [g.p[i] - start[i] for i in range(3)]
            a, before = before, b
            cross = [a[1] * b[2] - b[1] * a[2], a[2] * b[0] - b[2] * a[0], a[0] * b[1] - b[0] * a[1]]
            guess.across = [guess.across[i] + cross[i] for i in range(3)]
            guess.p = [guess.p[i] + g.p[i] for i in range(3)]
            guess.d = [guess.d[i] + g.d[i] for i in range(3)]
            guess.t = [guess.t[i] + g.t[i] for i in range(2)]
        guess.p = [x / len(ring) for x in guess.p]
        guess.t = [x / len(ring) for x in guess.t]
        return guess

    def word(self, column, guess):
        z = unzigzag(self.c[column].get())
        if self.grid_bits:
            return (math.floor(min(max(guess, -2.0e9), 2.0e9) + 0.5) + z) & MASK
        w = struct.unpack("<I", struct.pack("<f", min(max(guess, -3.0e38), 3.0e38)))[0]
        ordered = (w ^ MASK) if w >> 31 else w | 0x80000000
        ordered = (ordered + z) & MASK
        return ordered & 0x7FFFFFFF if ordered >> 31 else ordered ^ MASK

    def value(self, group, guess, words, position=True):
        if position:
            z = max(range(3), key=lambda i: (abs(guess.across[i]), -i))
            i, j = (z + 1) % 3, (z + 2) % 3
            words[i] = self.word(group, guess.p[i])
            words[j] = self.word(group + 1, guess.p[j])
            slope = 0.0
            if guess.across[z] != 0.0:
                slope = (guess.across[i] * (self.number(words[i]) - guess.p[i]) +
                         guess.across[j] * (self.number(words[j]) - guess.p[j])) / guess.across[z]
            words[z] = self.word(group + 2, guess.p[z] - slope)
        if self.normal_words == 2:
            words[3:5] = [self.word(group + 3 + i, float(signed(guess.words[i]))) for i in range(2)]
        elif self.normal_words == 3:
            d = guess.d
            z = max(range(3), key=lambda i: (abs(d[i]), -i))
            i, j = (z + 1) % 3, (z + 2) % 3
            length = math.sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) or 1.0
            words[3 + i] = self.word(group + 3, d[i] / length)
            words[3 + j] = self.word(group + 4, d[j] / length)
            x, y = self.number(words[3 + i]), self.number(words[3 + j])
            rest = 1.0 - x * x - y * y
            longest = math.sqrt(rest) if rest > 0.0 else 0.0
            words[3 + z] = self.word(group + 5, -longest if d[z] < 0.0 else longest)
        for i in range(2 if self.uvs else 0):
            words[self.uv_at + i] = self.word(group + 6 + i, guess.t[i])
        if self.colors:
            bytes_ = [((guess.color >> s) + unzigzag(self.c[group + 8].get())) & 0xFF for s in (0, 8, 16, 24)]
            words[self.color_at] = int.from_bytes(bytes(bytes_), "little")

    # Base and records

    def base(self, summary):
        vertices, _, faces = summary
        self.add_vertices(vertices)
        last = 0
        for material in sorted(faces):
            for _ in range(faces[material]):
                corners = []
                for _ in range(3):
                    last = self.difference(SPLIT, last)
                    corners.append(last)
                self.code_feature(self.add_face(material, *corners), self.feature)
                last = corners[0]
        for v in range(vertices):
            ring = [u for c in self.lists[v] or [] for u in (self.after(c), self.before(c)) if u < v]
            if ring:
                guess = self.inside(ring)
                guess.across = [0.0] * 3
            else:
                guess = self.like(v - 1) if v else Guess([0.0] * 3, [0.0] * 3, [0.0] * 2, 0, [0, 0])
            self.value(NEW, guess, self.values[v])

    def record(self):
        k = self.c[KIND].get()
        if k % 4 == 3:
            self.edit()
        else:
            self.fan(k % 4, (k >> 2) & 1, (k >> 3) & 3, (k >> 5) & 1)

    def corners_of_fan(self, mode, back):
        if mode == 2:
            corners = []
            for _ in range(self.c[CORNER].get()):
                self.corner = self.difference(CORNER, self.corner)
                corners.append(self.corner)
            return self.corner_vertex[corners[0]], corners
        step = self.c[SPLIT].get()
        self.split = v = self.split - step if back else self.split + step
        around = self.lists[v]
        n = len(around)
        if mode == 1:
            return v, [around[self.c[CORNER].get()] for _ in range(self.c[CORNER].get())]
        if n <= 8:
            x = self.c[RING + n - 1].get()
            start, count = x // n, x % n + 1
        else:
            start, count = self.c[RING_WIDE].get(), self.c[RING_WIDE].get()
        corners = [around[start]]
        while len(corners) < count:
            wanted = self.before(corners[-1])
            corners.append(next(c for c in around if self.after(c) == wanted))
        return v, corners

    def fan(self, kind, moves, mode, back):
        v, corners = self.corners_of_fan(mode, back)
        material = 0
        if self.materials > 1:
            x = self.c[MATERIAL].get()
            material = x - 1 if x else self.material_of(corners[0])
        ring = [v, self.after(corners[0])] + [self.before(c) for c in corners]
        guess, feature = self.inside(ring), self.face_feature[corners[0] // 3]
        s = len(self.lists)
        self.add_vertices(1)
        for c in corners:
            self.remove(v, c)
            self.append(s, c)
        faces = []
        if kind != 2:
            faces.append(self.add_face(material, s, v, ring[1]))
        if kind != 1:
            faces.append(self.add_face(material, s, ring[-1], v))
        self.value(NEW, guess, self.values[s])
        for face in faces:
            self.code_feature(face, feature)
        if moves:
            p, q = self.like(v), self.like(s).p
            p.p = [p.p[i] + (p.p[i] - q[i]) for i in range(3)]
            p.across = guess.across
            self.value(MOVED, p, self.values[v])

    def name(self, column, known):
        x = self.c[column].get()
        if x < len(known):
            return known[x]
        if column == EDIT_CORNER:
            self.corner = self.difference(ESCAPE, self.corner)
            return self.corner
        self.vertex = self.difference(ESCAPE, self.vertex)
        return self.vertex

    def vocabulary(self, first, merges):
        known, corners = [], []

        def add(u):
            if len(known) < 250 and u not in known:
                known.append(u)

        for i, m in enumerate(merges[:32]):
            add(first + i)
            add(m)
        for i, m in enumerate(merges[:32]):
            if m >= first or self.lists[m] is None or m in merges[:i]:
                continue
            for c in self.lists[m]:
                if len(corners) < 250:
                    corners.append(c)
                add(self.after(c))
                add(self.before(c))
        return known, corners

    def edit(self):
        nv, _, ng, nc, nm = [self.c[COUNT].get() for _ in range(5)]
        first, merges = len(self.lists), []
        for _ in range(nv):
            self.vertex = self.difference(MERGE, self.vertex)
            merges.append(self.vertex)
        known, corners = self.vocabulary(first, merges)
        self.add_vertices(nv)
        for _ in range(nc):
            corner = self.name(EDIT_CORNER, corners)
            to = self.name(TO, known)
            self.remove(self.corner_vertex[corner], corner)
            self.append(to, corner)
        for _ in range(ng):
            self.material = self.difference(GROUP, self.material)
            for _ in range(self.c[GROUP].get()):
                face = self.add_face(self.material, *[self.name(FACE, known) for _ in range(3)])
                self.code_feature(face, self.feature)
        for i, m in enumerate(merges):
            s = first + i
            same = i > 0 and self.c[SAME].get() != 0
            if same:
                self.values[s][:3] = self.values[s - 1][:3]
            like = self.like(m if m < s else s - 1) if s else Guess([0.0] * 3, [0.0] * 3, [0.0] * 2, 0, [0, 0])
            self.value(EDIT, like, self.values[s], not same)
        for _ in range(nm):
            u = self.name(EDIT_MOVED, known)
            self.value(EDIT, self.like(u), self.values[u])

    # Floats

    def floats(self, v):
        w = self.values[v]
        if not self.grid_bits:
            return struct.pack("<%dI" % self.words, *w)
        out = struct.pack("<3f", *[self.grid_corner[i] + signed(w[i]) * self.grid_step for i in range(3)])
        if self.normals:
            top = float((1 << self.normal_bits) - 1)
            x, y = signed(w[3]) / top * 2.0 - 1.0, signed(w[4]) / top * 2.0 - 1.0
            z = 1.0 - abs(x) - abs(y)
            if z < 0.0:
                x, y = (1.0 - abs(y)) * (-1.0 if x < 0.0 else 1.0), (1.0 - abs(x)) * (-1.0 if y < 0.0 else 1.0)
            length = math.sqrt(x * x + y * y + z * z)
            out += struct.pack("<3f", x / length, y / length, z / length)
        if self.uvs:
            out += struct.pack("<2f", *[signed(x) * self.uv_step for x in w[self.uv_at:self.uv_at + 2]])
        if self.colors:
            out += struct.pack("<I", w[self.color_at])
        return out


def main():
    with open(sys.argv[1], "rb") as file:
        model = Model(file.read())
    with open(sys.argv[2], "wb") as out:
        for face, feature in enumerate(model.face_feature):
            for corner in range(3 * face, 3 * face + 3):
                out.write(model.floats(model.corner_vertex[corner]))
            out.write(struct.pack("<I", feature))


if __name__ == "__main__":
    main()
