"""Drives a Blender window through the sidebar in Japanese, German and Chinese, at two scales, in a light theme too.

Not a test of pytest: a window is needed. `drive(bpy, ui)` is a generator that yields seconds to wait; `ui` acts on a
window of 1600 x 1000 and takes pictures, which a person looks at: is a label cut off, or English where it need not be?
Prints how many labels of Thenar's operators Blender shows in each language.
"""

import sys

LANGUAGES = ("ja_JP", "de_DE", "zh_HANS")
SCALES = {1.0: 1566, 1.7: 1540}
"""Scale of the interface: where its sidebar has room right of lists (pixels)."""
PAGES = {"SETUP": (4, 5), "RESULT": (3, 4), "RECORD": (1, 1), "DIAGNOSE": (1, 1)}
"""How many pictures of each tab, page by page, at either scale."""
WHEEL = 24
"""Turns of the wheel from page to page."""
LIGHT = "Blender_Light.xml"


def drive(bpy, ui):
    """The cards of the empty scene, then every tab of a solved sample, page by page."""
    for obj in list(bpy.data.objects):
        bpy.data.objects.remove(obj)
    open_all(bpy)
    view = bpy.context.preferences.view
    window = bpy.context.window_manager.windows[0]
    area = next(each for each in window.screen.areas if each.type == "VIEW_3D")
    with bpy.context.temp_override(window=window, area=area):
        bpy.ops.screen.screen_full_area()
    yield 2
    for language in LANGUAGES:
        speak(view, language)
        for _ in range(2):
            ui.sidebar("Thenar")
            yield 1.5
        ui.shot(f"{language}_start")
    bpy.ops.thenar.add_sample(kind="cylinder_48")
    yield 1
    bpy.ops.thenar.solve(show_map=True)
    yield 1
    for language in LANGUAGES:
        speak(view, language)
        shown = bpy.app.translations.pgettext_iface("Solve Contact", "Operator")
        print("LANGUAGE", language, bpy.app.translations.locale, shown)
        assert shown != "Solve Contact"
        for number, (scale, x) in enumerate(SCALES.items()):
            bpy.context.preferences.view.ui_scale = scale
            yield 2
            ui.sidebar("Thenar")
            yield 1
            for tab, pages in PAGES.items():
                bpy.context.window_manager.thenar_tabs.tab = tab
                yield from turn(ui, x, -90 if pages[number] > 1 else 0)  # over a short tab it would zoom the view
                for page in range(pages[number]):
                    ui.shot(f"{language}_{scale:g}_{tab}_{page}")
                    yield from turn(ui, x, WHEEL if page < pages[number] - 1 else 0)
    bpy.context.preferences.view.ui_scale = 1.0
    theme = next(path for path in bpy.utils.preset_paths("interface_theme"))
    bpy.ops.script.execute_preset(filepath=f"{theme}/{LIGHT}", menu_idname="USERPREF_MT_interface_theme_presets")
    speak(view, "ja_JP")
    yield 2
    ui.shot("ja_JP_light")


def turn(ui, x, steps):
    """Turn the wheel over the sidebar, right of its lists, which would take it; down for steps above 0."""
    for place in (x - 1, x):
        ui.move(place, 900)
        yield 0.4
    for number in range(abs(steps)):
        ui.click(x, 900, button=5 if steps > 0 else 4)
        if number % 6 == 5:
            yield 0.05
    yield 1.0


def speak(view, language):
    """Set Blender's language, as Preferences > Interface does."""
    view.language = language
    view.use_translate_interface = view.use_translate_tooltips = view.use_translate_reports = True


def open_all(bpy):
    """Register the panels again, so that none begins closed."""
    main = next(module for name, module in sys.modules.items() if name.endswith(".thenar.panels.main"))
    package = main.__name__.removesuffix(".panels.main")
    classes = [cls for cls in below(bpy.types.Panel) if cls.__module__.startswith(package) and cls.is_registered]
    classes = sorted(classes, key=lambda cls: depth(classes, cls))
    for cls in reversed(classes):
        bpy.utils.unregister_class(cls)
    for cls in classes:
        cls.bl_options = set(getattr(cls, "bl_options", ())) - {"DEFAULT_CLOSED"}
        bpy.utils.register_class(cls)


def below(cls):
    """All classes below it."""
    for each in cls.__subclasses__():
        yield each
        yield from below(each)


def depth(classes, cls):
    """How many panels are above it."""
    above = next((each for each in classes if each.__name__ == getattr(cls, "bl_parent_id", "")), None)
    return 0 if above is None else 1 + depth(classes, above)
