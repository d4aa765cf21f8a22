"""Formulas as MathML, which browsers draw by themselves: no script, and nothing from another host."""

import re

from docutils.utils.math.latex2mathml import tex2mathml

TAG = re.compile(r"\\tag\{([^}]*)\}")
SHORT = re.compile(r"\\t?frac ?(\d)(\d)")
UNKNOWN = {r"\tfrac": r"\frac", r"\quad": r"\ \ ", r"\qquad": r"\ \ \ \ "}  # to docutils


def mathml(formula, is_block):
    tag = TAG.search(formula)
    formula = TAG.sub("", formula)
    formula = SHORT.sub(r"\\frac{\1}{\2}", formula)
    for theirs, ours in UNKNOWN.items():
        formula = re.sub(re.escape(theirs) + r"(?![A-Za-z])", lambda _, ours=ours: ours, formula)
    drawn = tex2mathml(formula, as_block=is_block)
    return drawn, tag[1] if tag else ""


def visit_inline(writer, node):
    from docutils import nodes

    writer.body.append(mathml(node.astext(), False)[0])
    raise nodes.SkipNode


def visit_block(writer, node):
    from docutils import nodes

    drawn, tag = mathml(node.astext(), True)
    number = f'<span class="number">({tag})</span>' if tag else ""
    writer.body.append(f'<div class="formula">{drawn}{number}</div>\n')
    raise nodes.SkipNode


def setup(app):
    app.add_html_math_renderer("mathml", (visit_inline, None), (visit_block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
