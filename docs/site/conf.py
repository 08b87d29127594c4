"""How Sphinx makes the documentation site; `build.py` lays out its pages and runs it."""

import re
import sys
from pathlib import Path
from pkgutil import resolve_name

import matplotlib as mpl
from numpydoc.xref import DEFAULT_LINKS

import crawler2d as c2d

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path.insert(0, str(HERE / "extensions"))
mpl.use("Agg")
DEFAULT_LINKS.clear()  # numpydoc's links to Python and NumPy: their inventories are not at hand

project = "crawler2d"
author = "The crawler2d developers"
copyright = author
version = release = str(c2d.build_info()["version"])

extensions = [
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "numpydoc",
    "myst_nb",
    "sphinx_gallery.gen_gallery",
    "sphinx_codeautolink",
    "sphinx_copybutton",
    "sphinx_design",
    "contents",
    "mathml",
    "names",
    "signatures",
]
nitpicky = True
root_doc = "docs/index"
source_suffix = {".rst": "restructuredtext", ".md": "myst-nb", ".ipynb": "myst-nb"}
exclude_patterns = ["docs/site", "docs/gallery", ".trees"]
templates_path = [str(HERE / "templates")]
default_role = "py:obj"

# Pages and notebooks are those of the repository, as GitHub shows them.
myst_enable_extensions = ["dollarmath", "colon_fence"]
myst_fence_as_directive = ["math"]
myst_heading_anchors = 4
nb_execution_mode = "off"
nb_ipywidgets_js = {}  # notebooks have none, and the scripts would come from elsewhere
html_math_renderer = "mathml"

# The reference is the docstrings; types are written there.
add_module_names = False
autodoc_typehints = "none"
autodoc_member_order = "bysource"
autosummary_generate = True
numpydoc_show_class_members = False
numpydoc_xref_param_type = True
numpydoc_xref_ignore = "all"  # words of a type that name nothing of ours
documented = re.findall(
    r"^   ((?:[\w.]+\.)?[A-Z]\w+)$",
    "".join(page.read_text("utf-8") for page in (HERE.parent / "reference").glob("*.rst")),
    re.MULTILINE,
)
numpydoc_xref_aliases = {name.rpartition(".")[2]: f"crawler2d.{name}" for name in documented}
codeautolink_concat_default = True
# Where a class is defined, and where its members are documented.
public = {name: resolve_name(f"crawler2d.{name}") for name in documented}
codeautolink_inventory_map = {
    f"{cls.__module__}.{cls.__qualname__}.{member}": f"crawler2d.{name}.{member}"
    for name, cls in public.items()
    for member in dir(cls)
    if isinstance(cls, type) and not member.startswith("_")
}

gallery = HERE.parent / "gallery"
sphinx_gallery_conf = {
    "examples_dirs": [str(gallery)],
    "gallery_dirs": ["gallery"],
    "filename_pattern": r"\.py$",
    "within_subsection_order": "FileNameSortKey",
    "backreferences_dir": "gallery/backreferences",
    "doc_module": ("crawler2d",),
    "ignore_repr_types": r"matplotlib\.",  # the picture is there
    "show_signature": False,
    "show_memory": False,
    "write_computation_times": False,
    "download_all_examples": False,
    "notebook_extensions": set(),
    "remove_config_comments": True,
    "image_srcset": ["2x"],
}

# The explorer is compiled for browsers, which takes more than Python: it is there if it was made.
explorer = ROOT / "out" / "explorer.html"
if explorer.is_file():
    tags.add("explorer")  # noqa: F821 - Sphinx gives it
    html_extra_path = [str(explorer)]

html_theme = "pydata_sphinx_theme"
html_title = "crawler2d"
html_static_path = [str(HERE / "static")]
html_css_files = ["site.css"]
html_js_files = ["site.js"]
html_show_sourcelink = False
html_copy_source = False
# Pages that have no others below them.
html_sidebars: dict[str, list[str]] = {
    "CHANGELOG": [],
    "CONTRIBUTING": [],
    "docs/accuracy": [],
    "docs/dependencies": [],
    "docs/engines": [],
    "docs/index": [],
    "docs/physics": [],
    "docs/promises": [],
}
html_theme_options = {
    "navbar_align": "left",
    "header_links_before_dropdown": 7,
    "secondary_sidebar_items": {"**": ["page-toc"], "docs/index": []},
    "show_toc_level": 2,
    "navigation_with_keys": False,
    "footer_start": ["copyright"],
    "footer_end": [],
}
