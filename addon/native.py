"""The one import of the native module `thenar`, and what to tell the user where it fails."""

from typing import TYPE_CHECKING, Any

from . import names, status

if TYPE_CHECKING:
    from thenar import Contact as Contact
    from thenar import Elastomer as Elastomer
    from thenar import Material as Material
    from thenar import Product as Product
    from thenar import Skin as Skin

try:
    import thenar as module

    REASON = ""
except Exception as error:  # a broken wheel can raise anything, and the panel must still say why
    module = None  # type: ignore[assignment]
    REASON = f"{type(error).__name__}: {error}"


def problem() -> str:
    """Why the native module cannot be used, as one sentence; empty if it can."""
    if module is None:
        return f"the native module did not load ({REASON}) on {status.where()}; reinstall Thenar for this platform"
    loaded = getattr(module, "__version__", "unknown")
    if loaded != names.VERSION:
        return (
            f"the native module is version {loaded} and the extension {names.VERSION}; "
            "restart Blender to finish the update"
        )
    return ""


def error_types() -> tuple[type[Exception], ...]:
    """The exceptions of the native module that carry a sentence for the user."""
    return (module.ThenarError,) if module is not None else ()


def parameters() -> dict[str, Any]:
    """The table of material numbers by name; empty where the native module is missing."""
    return {row["name"]: row for row in module.parameters()} if module is not None else {}


def effects() -> list[Any]:
    """The library's catalogue of effects; empty where the native module is missing."""
    return module.effects() if module is not None else []


def published(preset: str) -> dict[str, float] | None:
    """Numbers by parameter name of a published material ("finger", "palm_layer" and so on), or None."""
    maker = getattr(module.Material, preset, None) if module is not None else None
    if maker is None:
        return None
    material = maker()
    numbers = {name: getattr(material, name) for name in parameters() if hasattr(material, name)}
    swelling = ("swelling_height_mm_per_n", "swelling_radius_mm", "swelling_width_mm")
    return numbers | dict(zip(swelling, material.swelling, strict=True))
