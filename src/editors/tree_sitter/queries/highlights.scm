; Made by `.ci/task regenerate` from the words that the parser knows.

["accept" "also" "as" "because" "certainty" "cite" "confirm" "constant" "count" "default" "define" "drop" "else" "every" "extends" "fact" "hard" "if" "in" "initially" "is" "law" "of" "one" "option" "override" "param" "presumed" "priority" "provisions" "quantity" "redefine" "reject" "require" "rule" "rulebook" "says" "semantics" "set" "signal" "silent" "soft" "soften" "some" "source" "step" "throughout" "title" "topic" "topics" "traffic" "type" "unless" "use" "vocabulary" "when"] @keyword
["F" "G" "H" "M" "O" "R" "S" "U" "W" "X" "Y" "always" "and" "eventually" "historically" "iff" "implies" "never" "next" "not" "once" "or" "previously" "release" "since" "strong" "then" "until" "weak" "xor"] @keyword.operator
["!" "!=" "&" "&&" "*" "+" "-" "->" ".." "/" "<" "<->" "<=" "<>" "=" ">" ">=" "[]" "^" "|" "||"] @operator
["(" ")" "[" "]" "{" "}"] @punctuation.bracket
["," ":" ";"] @punctuation.delimiter
["at" "do" "end" "finite" "force" "from" "left" "machine-readable" "off" "on" "point" "right" "secondary" "start" "stutter" "to" "unverified" "verified" "weight"] @keyword.modifier

(truth) @boolean
(comment) @comment
(string) @string
(numeral) @number
(date) @string.special
(unit) @type
(book) @module
(use_line (name) @module)
(vocabulary_line (name) @module)
(rule_head "rule" . (name) @function)
(drop_item "rule" . (name) @function)
(soften_item "rule" . (name) @function)
(define_item . ["define" "redefine"] . (name) @function)
(param_item "param" . (name) @constant)
(option_item "option" . (name) @constant)
(type_item (name) @type)
(parameter ":" (name) @type)
(variable ":" (name) @type)
(parameter . (name) @variable.parameter)
(variable . (name) @variable.parameter)
(atom . (name) @variable)
