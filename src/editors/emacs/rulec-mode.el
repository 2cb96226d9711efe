;;; rulec-mode.el --- Major mode for rulebooks of rulec  -*- lexical-binding: t; -*-

;; Made by `.ci/task regenerate` from the words that the parser knows.

;;; Code:

(defvar rulec-mode-syntax-table
  (let ((table (make-syntax-table)))
    (modify-syntax-entry ?# "<" table)
    (modify-syntax-entry ?\n ">" table)
    (modify-syntax-entry ?_ "w" table)
    table))

(defconst rulec-mode-keywords
  `(("\\_<\\(?:rule\\|define\\|redefine\\)\\s-+\\(\\w+\\)"
     1 font-lock-function-name-face)
    (,(regexp-opt '("accept" "also" "as" "because" "certainty" "cite" "confirm" "constant"
                   "count" "default" "define" "drop" "else" "every" "extends" "fact" "hard"
                   "if" "in" "initially" "is" "law" "of" "one" "option" "override" "param"
                   "presumed" "priority" "provisions" "quantity" "redefine" "reject"
                   "require" "rule" "rulebook" "says" "semantics" "set" "signal" "silent"
                   "soft" "soften" "some" "source" "step" "throughout" "title" "topic"
                   "topics" "traffic" "type" "unless" "use" "vocabulary" "when")
                  'symbols)
     . font-lock-keyword-face)
    (,(regexp-opt '("F" "G" "H" "M" "O" "R" "S" "U" "W" "X" "Y" "always" "and" "eventually"
                   "historically" "iff" "implies" "never" "next" "not" "once" "or"
                   "previously" "release" "since" "strong" "then" "until" "weak" "xor")
                  'symbols)
     . font-lock-builtin-face)
    (,(regexp-opt '("false" "true") 'symbols) . font-lock-constant-face)))

;;;###autoload
(define-derived-mode rulec-mode prog-mode "rulec"
  "Major mode for rulebooks and vocabularies of rulec."
  (setq-local comment-start "# "
              comment-start-skip "#+\\s-*"
              indent-line-function #'indent-relative
              font-lock-defaults '(rulec-mode-keywords)))

;;;###autoload
(add-to-list 'auto-mode-alist '("\\.rules\\'" . rulec-mode))

(provide 'rulec-mode)
;;; rulec-mode.el ends here
