"""Prints the packages that rattler-build makes of recipe.yaml, and the run-time dependencies of each."""

from pathlib import Path

from rattler_build import RenderConfig, Stage0Recipe, VariantConfig
from rattler_build.tool_config import PlatformConfig

FOLDER = Path(__file__).parent


def main() -> None:
    recipe = Stage0Recipe.from_file(FOLDER / "recipe.yaml")
    variants = VariantConfig.from_file(FOLDER / "variants.yaml")
    linux = RenderConfig(platform=PlatformConfig(target_platform="linux-64"))
    lines = set()
    for rendered in recipe.render(variants, linux):
        package = rendered.recipe.package
        needs = rendered.recipe.requirements.to_dict()["run"]
        words = ", ".join(word for word in needs if isinstance(word, str))
        lines.add(f"{package.name} {package.version} {rendered.recipe.build.string}\n   needs {words}")
    print("\n".join(sorted(lines)))


main()
