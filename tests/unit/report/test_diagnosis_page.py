"""Claims about report.html: whole, self-contained, with units, and what each verdict has to show."""

import base64
import re
from dataclasses import replace
from html.parser import HTMLParser

import diagnoses
import numpy as np
import pytest
from planted import run_of

import flexarm
from flexarm.named_effects import NamedEffect
from flexarm.output import stems
from flexarm.report.diagnosis import _figures, page, write
from flexarm.report.files import Drawing, style
from flexarm.residual_analysis.localisation import localise

VERDICTS = sorted(diagnoses.ALL)
VOID = {"meta", "img", "br", "wbr", "link", "input", "hr"}


class Page(HTMLParser):
    """Tags, texts and addresses of a page; refuses what is closed in the wrong order."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.addresses: list[str] = []
        self.images: list[dict[str, str | None]] = []
        self.headings: list[str] = []
        self.words: list[str] = []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attrs):
        given = dict(attrs)
        self.addresses += [given[key] for key in ("src", "href", "srcset", "data") if given.get(key)]
        if tag == "img":
            self.images.append(given)
        if tag not in VOID:
            self.open.append(tag)
        if tag in ("h1", "h2"):
            self.headings.append("")

    def handle_endtag(self, tag):
        assert self.open, f"</{tag}> closes nothing"
        assert self.open.pop() == tag

    def handle_data(self, data):
        if self.open and self.open[-1] not in ("style", "script"):
            self.words.append(data)
        if self.open and self.open[-1] in ("h1", "h2"):
            self.headings[-1] += data

    @property
    def text(self):
        return " ".join(" ".join(self.words).split())


@pytest.fixture(scope="module", params=VERDICTS)
def verdict(request):
    return request.param


@pytest.fixture(scope="module")
def written(verdict, tmp_path_factory):
    directory = tmp_path_factory.mktemp(verdict)
    write(diagnoses.ALL[verdict](), directory)
    return directory


@pytest.fixture(scope="module")
def html(written):
    return (written / "report.html").read_text(encoding="utf-8")


def test_every_tag_is_closed(html):
    assert Page(html).open == []


def test_page_fetches_nothing(html):
    page = Page(html)
    assert all(address.startswith("data:image/png;base64,") for address in page.addresses)
    assert "@import" not in html
    assert not re.search(r"url\(", html)
    assert "<script" not in html


def test_images_are_whole_and_have_a_text(html, written):
    files = {path.read_bytes() for path in written.glob("*.png")}
    for image in Page(html).images:
        content = base64.b64decode(image["src"].partition(",")[2])
        assert content in files
        assert len(image["alt"]) > 20


def test_no_number_is_missing(html):
    text = Page(html).text
    assert not re.search(r"\b(nan|inf|None|Undefined)\b", text)


def test_page_begins_with_the_verdict_and_ends_with_provenance(html):
    headings = Page(html).headings
    assert headings[-1] == "Provenance"
    assert (
        "missing" in headings[0] or "adequate" in headings[0] or "gap" in headings[0] or "data" in headings[0]
    )


def page_of(d):
    """The page without its figures."""
    return Page(page(d, [], d.to_json_dict()))


def test_effects_are_told_in_the_order_of_the_argument():
    d = diagnoses.of_effects()
    sections = ("where", "candidates", "shrinks", "constancy")
    told = Page(page(d, [Drawing("x", section, "", b"") for section in sections], d.to_json_dict()))
    assert told.headings == [
        "A physical effect is missing from the model",
        "Where simulation and measurement disagree",
        "The candidates and their evidence",
        "The repair",
        "The gap shrinks",
        "Does it stay the same from record to record?",
        "What is uncertain",
        "What to measure next",
        "Provenance",
    ]
    text = told.text
    assert "137.7 to 142.3 kN m/rad" in text
    assert "+stiffness = 140000.0" in text
    assert "link stiffness at rod , probability 0.07" in text
    assert "stays within its error" in text
    assert "210.0 GPa −2.0 GPa 1.0 GPa −1.0" in text  # one sigma of the stated per cent below nominal


def test_ratios_to_the_noise_are_explained_where_they_are_given():
    d = diagnoses.of_effects()
    html = page(d, [], d.to_json_dict())
    assert "Over noise: the rms gap of that part over" in html
    assert "“Times the noise”" not in html  # no sentence speaks of it
    d = replace(d, effects=(replace(d.effects[0], evidence="It falls from 4.3 to 0.31 times the noise."),))
    assert "“Times the noise”: what is left" in page(d, [], d.to_json_dict())


def test_an_unusable_record_is_told_by_channel_and_names_no_physics():
    page = page_of(diagnoses.unusable())
    assert "Which channel, and how" in page.headings
    assert "Channel tip_x_m runs against the motion." in page.text
    assert not {"The repair", "The gap shrinks", "What to measure next"} & set(page.headings)


def test_an_unexplained_rest_is_described_and_its_named_part_is_a_part():
    page = page_of(diagnoses.unexplained())
    assert "What remains" in page.headings
    assert "The part that has a name" in page.headings
    assert "The repair" not in page.headings
    assert page.text.count("oscillates at 0.7 Hz") == 1  # in the verdict, which the section points at


def test_an_adequate_model_has_no_repair_but_values_that_moved():
    page = page_of(diagnoses.adequate())
    assert "The values that move" in page.headings
    assert not {"The repair", "The candidates and their evidence"} & set(page.headings)


def test_a_parameter_that_moves_with_the_payload_is_said_to():
    [entry] = diagnoses.of_effects().constancy
    drifting = {**entry, "constant": False, "moves_with": "payload", "q": 40.0, "p_value": 1e-9}
    page = page_of(diagnoses.of_effects(constancy=(drifting,)))
    assert "moves with payload" in page.text


def test_texts_of_users_are_not_read_as_html():
    page = page_of(diagnoses.of_effects(remarks=("<b>bold</b> & <script>",)))
    assert "<b>bold</b> & <script>" in page.text
    assert page.open == []


# ---------------------------------------------------------------------------- figures


KINDS = {**diagnoses.ALL, "poses": diagnoses.of_poses, "torque": lambda: torque_only()}


def torque_only():
    """A motor without friction in the model, and nothing measured but its torque."""
    run = run_of("one joint")
    pair = run.showing({"hinge torque": lambda t: 30 * np.sign(run.state("drive_rate", t))})
    gap = flexarm.compare(run.simulation.arm, pair.record, simulation=run.simulation)
    named = NamedEffect("motor_friction", "hinge", 0.9, (diagnoses.estimate("coulomb", 30.0, "N m"),))
    return diagnoses.lean(
        effects=(named,),
        before={"other": gap},
        after={"other": gap},
        located=localise(pair),
        located_after=None,
        main_signal="hinge torque",
    )


@pytest.fixture(scope="module", params=sorted(KINDS))
def figures(request):
    with style():
        return {name: figure for name, _, _, figure in _figures(KINDS[request.param]()) if figure is not None}


def numeric(labels):
    return any(re.fullmatch(r"[−-]?[\d.]+", label.get_text()) for label in labels)


def test_every_axis_with_numbers_has_a_unit(figures):
    for name, figure in figures.items():
        figure.canvas.draw()
        for ax in figure.axes:
            for text, ticks in (
                (ax.get_xlabel(), ax.get_xticklabels()),
                (ax.get_ylabel(), ax.get_yticklabels()),
            ):
                shown = [tick for tick in ticks if tick.get_visible()]
                if (text or numeric(shown)) and text != "pose":
                    assert re.search(r"\[[^\[\]]+\]$", text), f"{name}: {text!r}"


def test_figures_are_those_that_the_page_needs(figures, request):
    shown = request.node.callspec.params["figures"]
    expected = {
        "effects": {"states", "bands", "stages", "candidates", "constancy", "joint_compliance-hinge"},
        "adequate": {"states", "bands"},
        "unexplained": {"states", "bands", "stages", "candidates", "constancy", "joint_compliance-hinge"},
        "unusable": set(),
        "poses": {"states", "rotations", "joint_compliance-elbow", "gap-poses"},
        "torque": {"states", "bands", "motor_friction-hinge", "gap-other"},
    }[shown]
    curves = (
        {"gap-slow", "gap-fast", "gap-other"} if shown in ("effects", "adequate", "unexplained") else set()
    )
    assert set(figures) == expected | curves


def test_records_that_would_share_a_file_get_their_own():
    names = ["a/b", "a b", "a-b", "a-b-2", "..", "/"]
    found = stems(names)
    assert len(set(found)) == len(names)
    assert all(re.fullmatch(r"[\w-][\w.-]*", stem) for stem in found)


def test_clocks_and_frames_are_told_against_something_and_only_as_far_as_they_were_found():
    d = diagnoses.of_effects()
    for text in (page_of(d).text, " ".join(d.summary().split())):
        assert "time delay at tracker, against the drive's clock" in text
        assert "frame registration at tracker, against its stated pose, in the base's axes" in text
        assert "rotation.y" in text
    assert "rotation.x" not in page_of(d).text
    assert "as stated, not determined: rotation.x" in d.summary()
