#!/usr/bin/env python3
# Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
"""Lists the figures of README's validation part that the page of `torso validate` does not have.

usage: readme_figures.py README.md report/index.html

A figure is there if the page has a number that rounds to it. Exit status 1 if any is missing.
"""
import html
import re
import sys

NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")


def main(readme_path, page_path):
    readme = open(readme_path, encoding="utf-8").read()
    part = readme[readme.index("\n## Validation"):]
    part = part[:part.index("\n## ", 1)]
    page = open(page_path, encoding="utf-8").read()
    page = re.sub(r'src="data:[^"]*"', "", page)
    page = html.unescape(re.sub(r"<[^>]*>", " ", page))
    found = {abs(float(n)) for n in NUMBER.findall(page)}
    missing = 0
    for line in part.splitlines():
        text = re.sub(r"`[^`]*`|\([^)]*(?:19|20)\d\d[^)]*\)", " ", line)  # commands, publications
        # Names of levels and of processors, years and dimensions are no figures.
        text = re.sub(r"\b[CTLS]\d+(?:/[CTLS]\d+)?\b|\b(?:19|20)\d\d\b|AVX-?\d+", " ", text)
        lost = []
        for n in NUMBER.findall(text):
            decimals = len(n.split(".")[1]) if "." in n and "e" not in n else 0
            half = 0.5000001 * 10 ** -decimals
            if not any(abs(abs(float(n)) - x) <= half for x in found):
                lost.append(n)
        if lost:
            missing += len(lost)
            print(", ".join(lost), "in:", line.strip()[:100])
    return 1 if missing else 0


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1], sys.argv[2]))
