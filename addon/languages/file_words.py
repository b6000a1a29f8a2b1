"""Templates of errors whose fields hold words of a file or of `study.toml`: keys, columns, names.

These are to be typed as they stand, so that no language translates them. Knows nothing of Blender.
"""

_UNDER = " under [recordings.columns] in study.toml, or --column "
TEMPLATES = frozenset(
    {
        'add mat = "..." with one of {value1}',
        "add [{key}s.{name}]",
        "column '{value1}' is taken as the {what}: no other is in {value2}",
        "give run as one of {value1}{more}",
        'leave one of them out, or name the one: {what} = "NAME" in study.toml, or --column {what}=NAME',
        'name it: {column} = "{first}"' + _UNDER + '"{column}={first}"',
        f'name them: force = "{{value1}}" and travel = "{{value2}}"{_UNDER}"force={{value1}}" '
        '--column "travel={value2}"',
        "name the column {value1}_{value2}",
        "no line of names holds {value1}",
        "no sheet of the workbook has columns {value1}",
        "the data hold no channel {value1}",
        "the {name} falls where the force grows; here it grows into the sample: name its column with a minus before "
        'the name, {name} = "-NAME"',
        "there is no column {name}; the first is {first}",
        "there is no effect {name}; there are {known}",
        "they are called {value1} to {value2}",
        "two columns hold {what}",
        "use one of {value1}",
        "which of its columns {value1} is the force, and which the depth or travel?",
        "which of {names} is it",
        "{name} is {option}, but must be one of {options}",
        "{what} is given twice; leave one of them out",
        "{what} names no column; give its name in the file",
        "'{name}' has no take '{take}'; it has {value}",
        ': which of {value1} is it? Name it: {key} = "{first}"' + _UNDER + '"{key}={first}"; a minus before the name '
        "turns the sign",
    }
)
FIELDS = {"key", "known"}
"""Fields that hold such words in every template."""
