"""A job file of sound cases with odd names, and of cases that each fail for a reason of their own."""

import os

BAD = [
    ("name = 'wrong type of file'\nblend = 5", "blend is 5, but must be a text in quotes"),
    ("name = 'wrong type of hand'\nhand = 7", "hand is 7, but must be a text"),
    ("name = 'force as text'\nforce_n = '2'", "force_n is '2', but must be a number above zero"),
    ("name = 'force below zero'\nforce_n = -2", "force_n is -2, but must be a number above zero"),
    ("name = 'force beyond measure'\nforce_n = 1e300", "must be 1e-06 to 1e+06"),
    ("name = 'force of no number'\nforce_n = nan", "must be a number above zero"),
    ("name = 'force without end'\nforce_n = inf", "must be a number above zero"),
    ("name = 'force of 400 digits'\nforce_n = 1" + "0" * 400, "a number of 401 digits"),
    ("name = 'part of a frame'\nframe = 1.5", "frame is 1.5, but must be a whole number"),
    ("name = 'far frame'\nframe = 1000000000000", "must be -1.04857e+06 to 1.04857e+06"),
    ("name = 'no model'\nmodel = 'clay'", 'must be "layer" or "paper"'),
    ("name = 'unknown key'\ncolour = 1", "unknown key 'colour'"),
    ("name = ['a list']", "name is ['a list'], but must be a text or a number"),
    ("name = 'twice'\nforce_n = 0", "force_n is 0"),
    ("name = 'twice'\nforce_n = 1", "has the name of another"),
    ("name = 'no such hand'\nhand = 'Paw'", "no object 'Paw'"),
    ("name = 'no such product'\nproduct = 'Cup'", "no object 'Cup'"),
    ("name = 'a light as hand'\nhand = 'Lamp'", "Lamp"),
    ("name = 'no file'\nblend = 'none.blend'", "there is no file"),
    ("name = 'text as file'\nblend = 'text.blend'", "cannot be opened"),
    ("name = 'file cut off'\nblend = 'cut.blend'", "cut.blend"),
    ("name = 'a folder'\nblend = 'folder.blend'", "there is no file"),
    ("name = 'a pipe'\nblend = 'pipe.blend'", "there is no file"),
    ("name = 'zeros without end'\nblend = '/dev/zero'", "there is no file"),
    ("name = 'NUL in a path'\nblend = \"a\\u0000b.blend\"", "is no path"),
    ("name = 'long path'\nblend = '" + "p" * 5000 + "'", ""),
    ("name = 'no such pose'\npose = 'wave'", "there is no pose 'wave'"),
    ("name = 'pose of no made hand'\npose = 'fist'", ""),
    ("name = 'size without fit'\nhand_percentile = 95", "add fit"),
    ("name = 'giant'\nfit = 'firm'\nhand_percentile = 100", "must lie below 100"),
    ("name = 'no strength'\nfit = 'iron'", 'must be "light" or "firm"'),
    ("name = 'two grips'\ngrip = 'cork'\ngrip_shore_a = 40", "which are two grips"),
    ("name = 'no grip'\ngrip = 'jelly'", "grip is 'jelly'"),
    ("name = 'grip of nothing'\ngrip_thickness_mm = 4", "is rigid"),
    ("name = 'grip without end'\ngrip = 'cork'\ngrip_thickness_mm = 1e9", "must be 0.1 to 1000"),
    ("name = 'stiffness of air'\nstiffness = 1e-9", "must be 0.0001 to 10000"),
    ("name = 'grip of diamond'\ngrip_youngs_mpa = 1e6", "must be 0.001 to 100000"),
    ("name = 'kept perhaps'\nsave = 'yes'", "save is 'yes', but must be true or false"),
    ("name = 'drawn once'\nrender = 1", "render is 1, but must be true or false"),
    ("name = 'a table as name of its files'\nout = {a = 1}", "must be a text or a number"),
]
"""(lines of a case, words that its row must hold)."""

ODD_NAMES = [
    *("force 0.5", "force 0.9", "", ".", "..", "../../outside", "/etc/passwd", "C:\\hands\\grip", "CON", "nul.2"),
    *("sheet", "Sheet", "sheet-1", "results", "x y", "x_y", "X Y", "=1+1", "@sum", "-rf", "*?", "a\tb", "a\nb"),
    *("\x1b[31mred", "\u202egrip", "握る", "قبضة", "e\u0301", "\u00e9", "🖐", "grip.", " grip", "grip ", "n" * 300),
    *("握" * 300, "n" * 299 + "m", "%s", "{0}", "$HOME", "a;b"),
]
"""Names of sound cases."""


def files(folder):
    """Make the odd files that `BAD` names, next to `ball.blend`."""
    (folder / "text.blend").write_text("a letter, no scene")
    whole = (folder / "ball.blend").read_bytes()
    (folder / "cut.blend").write_bytes(whole[: len(whole) // 2])
    (folder / "folder.blend").mkdir()
    os.mkfifo(folder / "pipe.blend")


def job_file(bad, good):
    """The text of a job file with `good` sound cases, odd names first, and the cases `bad` strewn among them."""
    names = [*ODD_NAMES, *(f"push {number}.5" for number in range(good))][:good]
    sound = [f"name = {_quoted(name)}\nforce_n = {0.4 + 0.002 * place:.3f}" for place, name in enumerate(names)]
    every = max(1, len(sound) // len(bad))
    cases = []
    for place, case in enumerate(sound):
        cases.append(case)
        if place % every == 0 and place // every < len(bad):
            cases.append(bad[place // every][0])
    return 'blend = "ball.blend"\nsave = false\n' + "".join(f"[[case]]\n{case}\n" for case in cases)


def _quoted(text):
    """A text as TOML has it, every sign but letters and digits of ASCII as a code."""
    return '"' + "".join(each if each.isascii() and each.isalnum() else f"\\U{ord(each):08x}" for each in text) + '"'
