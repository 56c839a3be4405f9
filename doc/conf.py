"""Configuration of the site that doc/build makes; its pages are in this folder, and README."""

import re
from pathlib import Path

import mathjax
from docutils import nodes
from pygments import token
from pygments.lexer import RegexLexer, bygroups

ROOT = Path(__file__).resolve().parents[1]

project = "GEARQUAT"
author = "The GEARQUAT developers"
html_title = "GEARQUAT"
html_theme = "furo"
# MathJax comes along, for reading without a network
MATHJAX = Path(mathjax.__file__).parent / "static" / "mathjax" / "es5" / "tex-svg-full.js"
mathjax_path = MATHJAX.name
html_static_path = ["_static", str(MATHJAX)]
html_css_files = ["site.css"]
html_copy_source = False
html_show_copyright = False
html_show_sphinx = False

extensions = ["myst_nb", "sphinx.ext.autodoc"]
autodoc_typehints = "none"
# the tutorial runs anew for each site; what a page does not show is written beside it
nb_execution_mode = "force"
nb_execution_in_temp = True
nb_execution_timeout = 300
nb_execution_raise_on_error = True
nb_output_stderr = "remove"
exclude_patterns = ["_static", "lammps_defects.md"]  # reports for LAMMPS, no page for users
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 3
highlight_language = "text"

nitpicky = True


# --- pages ----------------------------------------------------------------------------------------
def first_page(text):
    """The README, in front of the text of index.md."""
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    return (readme + text).replace("](doc/", "](").replace("](examples/README)", "](examples.md)")


def examples_page():
    """The unchanged README of each example; its first line is its title."""
    parts = ["# Examples"]
    for pattern in ("README", "*/README", "hard/*/README"):
        for readme in sorted((ROOT / "examples").glob(pattern)):
            title, _, text = readme.read_text(encoding="utf-8").partition("\n")
            folder = readme.parent.relative_to(ROOT)
            parts += [f"## {title}", f"`{folder}`", f"~~~text\n{text.strip()}\n~~~"]
    return "\n\n".join(parts) + "\n"


def read_page(app, docname, source):
    """README and examples are not in this folder; anchors in HTML become targets."""
    text = source[0]
    if docname == "index":
        text = first_page(text)
    elif docname == "examples":
        text = examples_page()
    text = re.sub(r"\]\(((?:\.\./)*)\.\./README\.md", r"](\1index.md", text)
    source[0] = re.sub(r'^<a id="(\w+)"></a>$', r"(\1)=", text, flags=re.MULTILINE)


def lammps_page(app, env, node, content):
    """Links of our page to other pages of LAMMPS' manual."""
    if node.get("refdoc") != "src/fix_gear_quat" or node.get("reftype") != "doc":
        return None
    page = node["reftarget"].removeprefix("/src/")
    return nodes.reference("", "", content, refuri=f"https://docs.lammps.org/{page}.html")


# --- what is shown ----------------------------------------------------------------------------------
class LammpsLexer(RegexLexer):
    """Input scripts."""

    name = "LAMMPS"
    tokens = {
        "root": [
            (r"#.*\n", token.Comment.Single),
            (r"^([ \t]*)([a-z]\w*)", bygroups(token.Whitespace, token.Keyword)),
            (r"(?<=\s)[-+]?[\d.]+(?:e[-+]?\d+)?(?=\s)", token.Number),
            (r"\$\{\w+\}|\$\w|[vcf]_\w+", token.Name.Variable),
            (r"\"[^\"\n]*\"|'[^'\n]*'", token.String),
            (r"\s+", token.Whitespace),
            (r"\S", token.Text),
        ]
    }


def setup(app):
    app.connect("source-read", read_page)
    app.connect("missing-reference", lammps_page)
    app.add_lexer("LAMMPS", LammpsLexer)
