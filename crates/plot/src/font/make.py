"""Makes inter.txt from Inter 4.1. Needs fonttools and brotli, and two files of the npm package inter-ui 4.1.1:

    python3 make.py web/Inter-Regular.woff2 web/Inter-SemiBold.woff2 > inter.txt

One line per glyph: weight (r, s), code point, advance, outline. 1000 units per em, y down, and the outline in the
path language of SVG with the four commands m l q z, all relative.
"""

import sys

from fontTools.pens.basePen import BasePen
from fontTools.pens.transformPen import TransformPen
from fontTools.ttLib import TTFont

UNITS = 1000
RANGES = [(0x20, 0x7E), (0xA1, 0xAC), (0xAE, 0xFF)]
GREEK_AND_SIGNS = "αβγδεζηθικλμνξοπρστυφχψωΓΔΘΛΞΠΣΦΨΩ−–—‘’“”„…′″‰•†‡→←↑↓√∂∞≈≠≤≥∑∫∅□"


class Outline(BasePen):
    """Writes whole units, each relative to the rounded point before, so that rounding does not add up."""

    def __init__(self, glyphs):
        super().__init__(glyphs)
        self.text, self.at = "", (0, 0)

    def relative(self, points):
        rounded = [(round(x), round(y)) for x, y in points]
        steps = [f"{x - self.at[0]} {y - self.at[1]}" for x, y in rounded]
        self.at = rounded[-1]
        return " ".join(steps)

    def _moveTo(self, point):
        self.text += "m" + self.relative([point])
        self.start = self.at

    def _lineTo(self, point):
        self.text += "l" + self.relative([point])

    def _qCurveToOne(self, control, point):
        self.text += "q" + self.relative([control, point])

    def _closePath(self):
        self.text += "z"
        self.at = self.start


def lines(weight, path):
    font = TTFont(path)
    scale = UNITS / font["head"].unitsPerEm
    glyphs, names = font.getGlyphSet(), font.getBestCmap()
    codes = [code for first, last in RANGES for code in range(first, last + 1)]
    for code in sorted(codes + [ord(sign) for sign in GREEK_AND_SIGNS]):
        glyph = glyphs[names[code]]
        pen = Outline(glyphs)
        glyph.draw(TransformPen(pen, (scale, 0, 0, -scale, 0, 0)))
        yield f"{weight} {code:04X} {round(glyph.width * scale)} {pen.text}".rstrip()


for line in [*lines("r", sys.argv[1]), *lines("s", sys.argv[2])]:
    print(line)
