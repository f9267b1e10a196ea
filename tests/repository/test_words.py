"""The pages' words: each language says the same, all of it is said somewhere, and each page gets what it says."""

import json
import re
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from server.camera.stream import SILENCE
from server.game.rules import DECLARED
from server.web.assets import asset
from server.web.words import LANGUAGES
from tests.support.programs import ROOT

STATIC = ROOT / "server" / "static"
TEMPLATES = ROOT / "server" / "web" / "templates"
PLACE = re.compile(r"\{(\w*)\}")
# a key in a call, a table or a condition; what follows a whole one is no part of it
KEY = re.compile(r"""["'`]([a-z]+\.[a-z][a-z0-9_]*)(?=["'`$])""")
# an unfinished key: t("desk.refused_" ~ code), t(`feed.${kind}`)
PREFIX = re.compile(
    r"""\bt\(\s*(?:"([a-z]+\.[a-z0-9_]*)"\s*[~+]|'([a-z]+\.[a-z0-9_]*)'\s*[~+]|`([a-z]+\.[a-z0-9_]*)\$\{)"""
)
SCRIPT = re.compile(r"""asset\(['"]js/([\w/]+)\.js['"]\)""")
SECTIONS = re.compile(r"\{% set sections = (\[.*?\]) %\}")
LOADS = re.compile(r"""\{% (?:extends|include) "(.+?)" %\}""")


def words(language: str) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((STATIC / "words" / f"{language}.json").read_text())
    return found


ENGLISH = {f"{section}.{key}": text for section, texts in words("en").items() for key, text in texts.items()}


def shape(text: Any) -> Any:
    """The places of a text, each way that it is said. One of a thing may be a word, such as "a minute"."""
    if isinstance(text, str):
        return sorted(PLACE.findall(text))
    assert set(text) == {"one", "other"}
    return {"one": set(shape(text["one"])) - {"n"}, "other": shape(text["other"])}


@pytest.mark.parametrize("language", [language for language in LANGUAGES if language != "en"])
def test_each_language_has_the_same_keys_and_places(language: str) -> None:
    other = words(language)
    assert {section: set(texts) for section, texts in other.items()} == {
        section: set(texts) for section, texts in words("en").items()
    }
    other_shapes = {f"{section}.{key}": shape(text) for section, texts in other.items() for key, text in texts.items()}
    assert other_shapes == {key: shape(text) for key, text in ENGLISH.items()}


def test_there_is_a_file_for_each_language_and_no_other() -> None:
    assert {path.stem for path in (STATIC / "words").iterdir()} == set(LANGUAGES)


def test_texts_that_are_chosen_by_number_need_it_as_n() -> None:
    """A language that counts has no other place for the number."""
    for key, text in ENGLISH.items():
        if isinstance(text, dict):
            assert "n" in PLACE.findall(text["other"]), key


@cache
def said(path: Path) -> tuple[frozenset[str], frozenset[str]]:
    """The keys that a file names, and the beginnings of keys."""
    text = path.read_text()
    prefixes = {"".join(match) for match in PREFIX.findall(text)}
    sections = {key.partition(".")[0] for key in ENGLISH}
    called = set(re.findall(r"""\bt\(\s*["']([^"'$]+)["']\s*[,)]""", text))
    keys = called | {
        key for key in KEY.findall(text) if key.partition(".")[0] in sections and not key.endswith(".html")
    }
    return frozenset(keys - prefixes), frozenset(prefixes)


SOURCES = [
    *sorted((STATIC / "js").rglob("*.js")),
    *sorted(TEMPLATES.rglob("*.html")),
    *sorted((ROOT / "server/web").glob("*.py")),
    *sorted((ROOT / "server/pages").glob("*.py")),
]


def test_what_pages_say_is_in_the_words() -> None:
    missing = [f"{path.relative_to(ROOT)}: {key}" for path in SOURCES for key in sorted(said(path)[0] - ENGLISH.keys())]
    assert missing == []
    unfounded = [prefix for path in SOURCES for prefix in said(path)[1] if not keys_with(prefix)]
    assert unfounded == []


def test_all_words_are_said_somewhere() -> None:
    named = {key for path in SOURCES for key in said(path)[0]}
    begun = {key for path in SOURCES for prefix in said(path)[1] for key in keys_with(prefix)}
    assert sorted(ENGLISH.keys() - named - begun) == []


def keys_with(prefix: str) -> set[str]:
    return {key for key in ENGLISH if key.startswith(prefix)}


@cache
def sections_of(script: str) -> frozenset[str]:
    """The sections of words that the bundle of this script says: what it imports and uses."""
    text = (STATIC / "bundle" / asset(f"js/{script}.js").rpartition("/")[2]).read_text()
    return frozenset(section for section in words("en") if re.search(rf"""["'`]{section}\.\w*["'`$]""", text))


def family(template: Path) -> str:
    """The text of a template with what it extends and includes."""
    text = template.read_text()
    return text + "".join(family(TEMPLATES / other) for other in LOADS.findall(text) if other.endswith(".html"))


PAGES = [path for path in sorted(TEMPLATES.rglob("*.html")) if "{% extends" in path.read_text()]


@pytest.mark.parametrize("template", PAGES, ids=lambda path: str(path.relative_to(TEMPLATES)))
def test_a_page_gets_the_words_that_its_scripts_say(template: Path) -> None:
    text = family(template)
    declared = SECTIONS.search(text)
    has = {"common", *(re.findall(r'"(\w+)"', declared.group(1)) if declared else [])}
    says = {section for script in SCRIPT.findall(text) for section in sections_of(script)}
    assert says <= has, f"its scripts say {sorted(says - has)}, too"


def test_each_rule_of_the_desk_has_a_name() -> None:
    assert {f"desk.rule_{rule}" for rule in DECLARED} <= ENGLISH.keys()


def test_the_page_knows_the_relays_reasons_as_the_relay_says_them() -> None:
    sources = "".join(path.read_text() for path in (ROOT / "server" / "camera").glob("*.py"))
    reasons = re.findall(r'^  "(.+)": "camera\.', (STATIC / "js/camera/words.js").read_text(), re.MULTILINE)
    assert len(reasons) > 5
    said_by_relay = sources.replace("{SILENCE:g}", f"{SILENCE:g}")
    assert [reason for reason in reasons if f'"{reason}"' not in said_by_relay] == []
