"""OpenMetrics text, against the text of the specification (version 1.0, sections 5.1 to 5.3)."""

import math

from catseye.app.service.openmetrics import Family, Sample, exposition


def test_a_counter_has_unit_help_and_suffix() -> None:
    family = Family("acme_router_seconds", "counter", "Time.", (Sample(17.0, {"path": "/"}),), "seconds")
    assert exposition([family], {"env": "prod"}) == (
        "# TYPE acme_router_seconds counter\n"
        "# UNIT acme_router_seconds seconds\n"
        "# HELP acme_router_seconds Time.\n"
        'acme_router_seconds_total{env="prod",path="/"} 17.0\n'
        "# EOF\n"
    )


def test_labels_escape_backslash_quote_and_line_feed() -> None:
    family = Family("a", "gauge", "b", (Sample(1.0, {"c": 'x\\y"z\n'}),))
    assert '{c="x\\\\y\\"z\\n"} 1.0\n' in exposition([family], {})


def test_what_is_no_number_is_written_as_specified() -> None:
    samples = tuple(Sample(value, {}) for value in (math.nan, math.inf, -math.inf))
    text = exposition([Family("a", "gauge", "b", samples)], {})
    assert text.splitlines()[2:] == ["a NaN", "a +Inf", "a -Inf", "# EOF"]


def test_a_family_without_values_is_left_out() -> None:
    assert exposition([Family("a", "gauge", "b", ())], {}) == "# EOF\n"
