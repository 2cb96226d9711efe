"""The major mode for Emacs: comments, strings, and words of the language."""

from __future__ import annotations

from rulec.syntax import highlighting as words

_MODE = """;;; rulec-mode.el --- Major mode for rulebooks of rulec  -*- lexical-binding: t; -*-

;; Made by `.ci/task regenerate` from the words that the parser knows.

;;; Code:

(defvar rulec-mode-syntax-table
  (let ((table (make-syntax-table)))
    (modify-syntax-entry ?# "<" table)
    (modify-syntax-entry ?\\n ">" table)
    (modify-syntax-entry ?_ "w" table)
    table))

(defconst rulec-mode-keywords
  `(("\\\\_<\\\\(?:rule\\\\|define\\\\|redefine\\\\)\\\\s-+\\\\(\\\\w+\\\\)"
     1 font-lock-function-name-face)
    (,(regexp-opt '({structure})
                  'symbols)
     . font-lock-keyword-face)
    (,(regexp-opt '({operators})
                  'symbols)
     . font-lock-builtin-face)
    (,(regexp-opt '({constants}) 'symbols) . font-lock-constant-face)))

;;;###autoload
(define-derived-mode rulec-mode prog-mode "rulec"
  "Major mode for rulebooks and vocabularies of rulec."
  (setq-local comment-start "# "
              comment-start-skip "#+\\\\s-*"
              indent-line-function #'indent-relative
              font-lock-defaults '(rulec-mode-keywords)))

;;;###autoload
(add-to-list 'auto-mode-alist '("\\\\.rules\\\\'" . rulec-mode))

(provide 'rulec-mode)
;;; rulec-mode.el ends here
"""


def emacs_mode() -> str:
    """Generate ``rulec-mode.el``."""
    structure = (*words.STRUCTURE_WORDS, *words.CLAUSES, *words.JOINING_WORDS)
    filled = _MODE.replace("{structure}", _listed(structure))
    filled = filled.replace("{operators}", _listed(words.OPERATORS))
    return filled.replace("{constants}", _listed(words.CONSTANTS))


def _listed(texts: tuple[str, ...]) -> str:
    """Return Lisp strings, as many on a line as fit."""
    lines = [""]
    for text in sorted(texts):
        if len(lines[-1]) + len(text) > 70:
            lines.append("")
        lines[-1] += f' "{text}"' if lines[-1] else f'"{text}"'
    return "\n                   ".join(lines)
