# SPDX-License-Identifier: Apache-2.0
"""Markdown, as far as this project's own pages use it, into man(7).

Headings, paragraphs, lists, tables, fenced code; in a line `code`, **strong**, *emphasis*, [text](link). Two-column tables become
tagged paragraphs, narrow ones of more columns stay tables, wide ones become tagged paragraphs with what else a row says behind.
Debian's own converters write what `mandoc -T lint` and `man --warnings` complain about.
"""
import re

WIDEST_CELL = 22  # of a table's columns but the last, to fit 80 columns with it


def escaped(text):
    return text.replace("\\", "\\e")


def exact(text):
    """What is typed or printed as it stands: a hyphen there is a minus sign, a quote no typographer's."""
    return escaped(text).replace("-", "\\-").replace("'", "\\(aq").replace("`", "\\(ga").replace("^", "\\(ha").replace("~", "\\(ti")


def line_start(text):
    """A line that begins with a dot or an apostrophe would be a macro."""
    return "\\&" + text if text[:1] in (".", "'") else text


INLINE = re.compile(r"`([^`]+)`|\*\*(.+?)\*\*|(?<![\w*])\*([^*\s][^*]*?)\*(?![\w*])|!?\[((?:[^\]\\]|\\.)*)\]\(([^)]*)\)")


def inline(text):
    """A run of Markdown text as roff, on one line."""
    out, at = "", 0
    text = " ".join(text.split())
    for found in INLINE.finditer(text):
        out += escaped(text[at:found.start()])
        code, strong, emphasis, label, link = found.groups()
        if code is not None:
            out += "\\fB" + exact(code) + "\\fR"
        elif strong is not None:
            out += "\\fB" + exact(strong.replace("`", "")) + "\\fR"
        elif emphasis is not None:
            out += "\\fI" + escaped(emphasis) + "\\fR"
        elif not found.group(0).startswith("!"):
            out += inline(label) + (f" \\(la{exact(link)}\\(ra" if link.startswith("http") else "")
        at = found.end()
    return out + escaped(text[at:])


def sentences(text):
    """roff wants a sentence a line, so that it spaces them itself."""
    return [line_start(part) for part in re.split(r"(?<=[a-z0-9)][.!?:]) +(?=[A-Z\\])", inline(text)) if part]


def cells(row):
    return [cell.strip().replace("\0", "|") for cell in row.replace("\\|", "\0").strip().strip("|").split("|")]


def plain_length(cell):
    return len(re.sub(r"[`*]|\]\([^)]*\)|\[", "", cell))


def table(rows):
    head, body = cells(rows[0]), [cells(row) for row in rows[2:]]
    narrow = all(plain_length(cell) <= WIDEST_CELL for row in body for cell in row[:-1])
    out = []
    if len(head) == 2 or not narrow:
        for row in body:
            out += [".TP", line_start(inline(row[0]) or "\\&")]
            out += sentences(row[1] or "\\(en")
            for name, cell in zip(head[2:], row[2:]):
                if cell:
                    out += [".br", f"\\fI{inline(name)}\\fR: " + inline(cell)]
        return out + [".PP"]
    out += [".TS", "tab(\t);", " ".join(["lb"] * len(head)), " ".join(["l"] * len(head)) + "."]
    out.append("\t".join(inline(cell) for cell in head))
    for row in body:
        out.append("\t".join(inline(cell) for cell in row[:-1]) + "\tT{")
        out += [line_start(inline(row[-1])) or "\\&", "T}"]
    return out + [".TE", ".PP"]


def code(lines):
    return [".PP", ".RS 4", ".EX", *(line_start(exact(line)) for line in lines), ".EE", ".RE"]


def tagged(term, text):
    """One entry of a list of terms; `term` and `text` are Markdown."""
    return [".TP", line_start(inline(term)), *(sentences(text) or ["\\&"])]


class Page:
    def __init__(self, title, section, date, source, volume):
        self.lines = ['.\\" Made in the build; see tools/manual. Do not edit.',
                      f'.TH {exact(title.upper())} {section} "{date}" "{exact(source)}" "{volume}"']

    def heading(self, text):
        self.lines.append(f'.SH "{inline(text.upper())}"')

    def subheading(self, text):
        self.lines.append(f'.SS "{inline(text)}"')

    def add(self, lines):
        self.lines += lines

    def markdown(self, text, demote=0):
        """Headings of level 1 are sections, all below them subsections; `demote` moves them down."""
        for kind, lines in blocks(text):
            if self.lines[-1] == '.SH "NAME"':  # what whatis(1) reads: name \- what it is, on one line
                self.add([inline(" ".join(lines)).replace(" - ", " \\- ", 1)])
            elif kind == "heading":
                level, title = lines
                if level + demote <= 1:
                    self.heading(title)
                else:
                    self.subheading(title)
            elif kind == "code":
                self.add(code(lines))
            elif kind == "table":
                self.add(table(lines))
            elif kind == "list":
                for marker, item in lines:
                    self.add([f'.IP {marker} 4', *sentences(item)])
                self.add([".PP"])
            else:
                self.add([".PP", *sentences(" ".join(lines))])

    def text(self):
        """Without paragraph breaks that stand next to another break, or before or behind nothing."""
        out = []
        for line in self.lines:
            if line == ".PP" and out and (out[-1] == ".PP" or out[-1].startswith((".SH", ".SS"))):
                continue
            if line.startswith((".SH", ".SS", ".TP", ".IP")) and out and out[-1] == ".PP":
                out.pop()
            out.append(line)
        while out[-1] == ".PP":
            out.pop()
        tables = any(line == ".TS" for line in out)
        return ("'\\\" t\n" if tables else "") + "\n".join(out) + "\n"


def blocks(text):
    """(kind, lines) of a Markdown text: heading, code, table, list, paragraph."""
    lines, at = text.split("\n"), 0
    while at < len(lines):
        line = lines[at]
        if not line.strip():
            at += 1
        elif found := re.match(r"(#+) +(.*)", line):
            yield "heading", (len(found.group(1)), found.group(2))
            at += 1
        elif found := re.match(r"( *)```", line):
            indent, end = len(found.group(1)), at + 1
            while not lines[end].strip().startswith("```"):
                end += 1
            yield "code", [row[indent:] for row in lines[at + 1:end]]
            at = end + 1
        elif line.startswith("|"):
            end = at
            while end < len(lines) and lines[end].startswith("|"):
                end += 1
            yield "table", lines[at:end]
            at = end
        elif re.match(r"(\* |- |\d+\. )", line):
            items = []
            while at < len(lines) and lines[at].strip():
                found = re.match(r"(\* |- |(\d+)\. )(.*)", lines[at])
                if found:
                    items.append([f'"{found.group(2)}."' if found.group(2) else "\\(bu", found.group(3)])
                else:
                    items[-1][1] += " " + lines[at].strip()
                at += 1
            yield "list", items
        else:
            end = at
            while end < len(lines) and lines[end].strip() and not re.match(r"#+ |```|\||\* |- ", lines[end]):
                end += 1
            end = max(end, at + 1)
            yield "paragraph", lines[at:end]
            at = end
