#!/usr/bin/env python3
# /// script
# dependencies = ["fonttools==4.68.0"]
# ///
"""Makes the two fonts here; README.md says from what, what is left out and why.

    python3 assets/font/subset.py path/to/Ubuntu-Light.ttf
"""

import pathlib
import sys

from fontTools import subset
from fontTools.ttLib import TTFont

LATIN = [
    (0x20, 0x17F),  # Latin, Latin-1, Latin Extended-A
    (0x18F, 0x18F), (0x192, 0x192), (0x218, 0x21B), (0x259, 0x259),  # Azerbaijani, ƒ, Romanian
    (0x1E80, 0x1E85), (0x1EF2, 0x1EF3),  # Welsh
    (0x2C6, 0x2DD),  # spacing accents
    (0x2000, 0x2BFF),  # punctuation, superscripts, currencies, fractions, mathematics, arrows
]
GREEK_AND_CYRILLIC = [
    (0x370, 0x3FF),  # Greek, without the polytonic letters
    (0x400, 0x45F), (0x490, 0x493), (0x49A, 0x49B), (0x4A2, 0x4A3),  # Cyrillic of Europe, then of Kazakh, Kyrgyz, Mongolian
    (0x4AE, 0x4B1), (0x4BA, 0x4BB), (0x4D8, 0x4D9), (0x4E8, 0x4E9),  # and Tatar
]
# Σ and π, which the interface writes.
SIGNS = [(0x3A3, 0x3A3), (0x3C0, 0x3C0)]

NAME = "Ubuntu Light derivative Gaitway"


def make(name, ranges):
    options = subset.Options()
    options.hinting = False
    options.layout_features = ["kern"]
    options.name_IDs = ["*"]
    options.notdef_outline = True
    options.drop_tables += ["GSUB", "VDMX", "gasp", "hdmx"]
    font = TTFont(sys.argv[1], recalcTimestamp=False)
    subsetter = subset.Subsetter(options)
    subsetter.populate(unicodes=[code for first, last in ranges for code in range(first, last + 1)])
    subsetter.subset(font)
    for record in font["name"].names:
        if record.nameID in (1, 4, 16):
            record.string = name
        elif record.nameID == 6:
            record.string = name.replace(" ", "-")
    font.save(pathlib.Path(__file__).with_name(name.replace(" ", "-") + ".ttf"))


make(NAME, LATIN + GREEK_AND_CYRILLIC)
make(NAME + " Latin", LATIN + SIGNS)
