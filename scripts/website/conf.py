# Settings of Sphinx; scripts/website/build.py makes the pages.
import os
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent))

project = "Resilin"
author = "the authors of Resilin"
copyright = "the authors of Resilin, MIT licence"
version = release = os.environ.get("RESILIN_VERSION", "")
extensions = ["myst_parser", "mathml"]
myst_enable_extensions = ["dollarmath"]
myst_dmath_double_inline = True
html_math_renderer = "mathml"
source_suffix = {".rst": "restructuredtext", ".md": "markdown"}
root_doc = "index"
default_role = "code"
smartquotes = False
myst_heading_anchors = 6
suppress_warnings = ["misc.highlighting_failure"]  # names such as `direction` are no languages
html_theme = "furo"
html_title = "Resilin"
html_short_title = "Resilin"
html_static_path = ["static"]
html_favicon = "static/icon.svg"
html_css_files = ["site.css"]
html_search_scorer = str(pathlib.Path(__file__).with_name("scorer.js"))
html_js_files = ["site.js"]
html_extra_path = [os.environ.get("RESILIN_SITE_FILES", "extra")]
html_copy_source = False
html_show_sphinx = False
html_theme_options = {"top_of_page_buttons": [], "navigation_with_keys": True}
toc_object_entries_show_parents = "hide"
python_use_unqualified_type_names = True
python_display_short_literal_types = True
add_module_names = False
