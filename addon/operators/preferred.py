"""What the user prefers, as set in the extension's preferences; defaults where the extension runs without them."""

_PACKAGE = __package__.rpartition(".")[0]


def get(context, name, otherwise):
    """The preference of that name; `otherwise` where there are no preferences, as in scripts and tests."""
    addon = context.preferences.addons.get(_PACKAGE)
    return getattr(addon.preferences, name, otherwise) if addon is not None else otherwise
