"""R07: files and where they are."""

from rulec.diagnostics.explanations.explanation import Explanation

FILES = {
    "R0701": Explanation(
        "a file cannot be read",
        "There is no such file, it is a folder, or it may not be read; the message says which.",
        "rulec check ./no_such.rules",
        "echo 'rulebook a signal p hard rule r { require p }' > such.rules\n"
        "rulec check ./such.rules",
        "command",
    ),
    "R0702": Explanation(
        "a file cannot be written",
        "The folder does not exist and cannot be made, something else has its name, it may not be "
        "written to, or the disk is full. Nothing is left behind half written.",
        "echo notes > build\nrulec compile esterle2019 -o build",
        "echo notes > notes\nrulec compile esterle2019 -o build",
        "command",
    ),
    "R0703": Explanation(
        "a name was not found on the search path",
        "A rulebook or a vocabulary with this name is neither beside the file that asks for it "
        "nor among those that ship with rulec (`rulec list`). A file is given by its path, such "
        "as `./mine.rules`.",
        "rulebook example\nuse papr\nhard rule r { require not CONGESTED }\n",
        "rulebook example\nuse paper\nhard rule r { require not CONGESTED }\n",
    ),
    "R0704": Explanation(
        "a project's settings are wrong",
        "The nearest `rulec.toml`, in the working folder or above it, is not TOML, has an unknown "
        "setting, or lists in `search_path` something that is no folder.",
        "echo 'search_path = [\"no_such\"]' > rulec.toml\nrulec compile esterle2019 -o out",
        "mkdir books\necho 'search_path = [\"books\"]' > rulec.toml\n"
        "rulec compile esterle2019 -o out",
        "command",
    ),
    "R0705": Explanation(
        "an older audit cannot be read",
        "An audit can be compared with another rulebook, or with a file that `rulec audit` has "
        "written as JSON. This file is something else, or was cut off.",
        "echo '{}' > old.json\nrulec audit esterle2019 --compare old.json",
        "rulec audit esterle2019 --output-format json > old.json\n"
        "rulec audit esterle2019 --compare old.json",
        "command",
    ),
    "R0706": Explanation(
        "a Parquet file cannot be read or written here",
        "It takes the package `pyarrow`, which is installed on request: `pip install "
        "'rulec[parquet]'`. And it takes a file: a Parquet file has its table of contents at the "
        "end, so it cannot be read from a pipe.",
        "echo PAR1 | rulec verify - --format parquet -r esterle2019",
        "echo '{\"states\": [{}]}' | rulec verify - --format jsonl -r esterle2019",
        "command",
    ),
    "R0707": Explanation(
        "a picture cannot be written as PNG",
        "It takes the package `matplotlib`, which is installed on request: `pip install "
        "'rulec[pictures]'`. And a picture with very many layers is longer than a PNG can "
        "sensibly be. SVG and HTML have neither limit.",
        "rulec draw scene s1 --step 0.01 -o s1.png",
        "rulec draw scene s1 --step 0.01 -o s1.html",
        "command",
    ),
}
