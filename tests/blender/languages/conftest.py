"""Thenar in each language that it has a table for."""

from types import SimpleNamespace

import pytest
from thenar_blender import languages


@pytest.fixture(params=sorted(languages.LANGUAGES))
def language(request, monkeypatch):
    """Thenar as in a Blender of this language; bpy as a module has no translations."""

    def look_up(template, context="*"):
        return languages.table(request.param).get((context, template), template)

    said = SimpleNamespace(pgettext_iface=look_up, pgettext_rpt=look_up, pgettext_tip=look_up)
    monkeypatch.setattr(languages, "bpy", SimpleNamespace(app=SimpleNamespace(translations=said)))
    return request.param
