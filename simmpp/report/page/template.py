"""HTML from templates: everything that comes from rows is escaped."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import jinja2
from markupsafe import Markup

from simmpp.plot.plotly_panels import script
from simmpp.report.page.glossary import glossary

ASSETS = "assets"


def rendered(template: str, values: Mapping[str, Any]) -> str:
    """A page that needs nothing else: styles, scripts and data are in it."""
    loader = jinja2.PackageLoader(__name__.rpartition(".")[0], ASSETS)
    environment = jinja2.Environment(
        loader=loader,
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    # NaN is no JSON: better an error here than a page whose scripts stop at it.
    environment.policies["json.dumps_kwargs"] = {"separators": (",", ":"), "allow_nan": False}

    def asset(name: str) -> Markup:  # our own styles and scripts, which escaping would break
        return Markup(environment.get_template(name).render())

    given = {"asset": asset, "plotly": Markup(script()), "glossary": glossary()}
    return environment.get_template(template).render(**values, **given)
