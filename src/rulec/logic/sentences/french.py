"""French. Phrases are main clauses, so that they can follow a colon."""

from __future__ import annotations

import re

from rulec.logic.formula import BinaryOperator, UnaryOperator
from rulec.logic.sentences.language import (
    Language,
    SpanWords,
    TypeWords,
)

FRENCH = Language(
    code="fr",
    semicolon=" ;",
    decimal_mark=",",
    quoted="« {} »",
    inner_joints=re.compile(r",| et | ou "),
    no_pause_after=(" :", ","),
    runs_on=(),
    and_="et",
    or_="ou",
    then="puis",
    the_name="« {} »",
    the_name_of="« {} » de {}",
    value=("{} est « {} »", "{} n'est pas « {} »"),
    value_is="{} est de {}",
    atom=("« {} » est vrai", "« {} » n'est pas vrai"),
    constants=("tout est possible", "l'impossible est vrai"),
    atom_of=("« {} » est vrai de {}", "« {} » n'est pas vrai de {}"),
    truth=("la relation « {} » est vraie", "la relation « {} » n'est pas vraie"),
    same=("{} est le même que {}", "{} n'est pas le même que {}"),
    kind=("{} est {}", "{} n'est pas {}"),
    relations={
        "<": ("{} est de moins de {}", "{} n'est pas de moins de {}"),
        "<=": ("{} est d'au plus {}", "{} n'est pas d'au plus {}"),
        "=": ("{} est exactement de {}", "{} n'est pas exactement de {}"),
        "!=": ("{} diffère de {}", "{} ne diffère pas de {}"),
        ">=": ("{} est d'au moins {}", "{} n'est pas d'au moins {}"),
        ">": ("{} est de plus de {}", "{} n'est pas de plus de {}"),
    },
    times="fois",
    counted={
        "<": "moins de {}",
        "<=": "au plus {}",
        "=": "exactement {}",
        "!=": "un nombre autre que {}",
        ">=": "au moins {}",
        ">": "plus de {}",
    },
    there_is="il y a {} {} avec ceci :",
    there_is_no="il n'y a {} {} avec ceci :",
    there_are="il y a {} {} avec ceci :",
    number_of="l'effectif des {} {} (avec ceci : {})",
    type_words=TypeWords(
        every="tout objet « {} »",
        other="tout autre objet « {} »",
        one="un objet « {} »",
        none="aucun objet « {} »",
        noun="objet « {} »",
        plural="objets « {} »",
    ),
    for_every="pour {} : ",
    step="pas",
    steps="pas",
    span=SpanWords("{} ou davantage", "jusqu'à {}", "de {} à {}", "exactement {}"),
    later="plus tard",
    after_start="après le début",
    before="auparavant",
    lasting=SpanWords(
        "pendant au moins {}", "pendant au plus {}", "pendant {} à {}", "pendant exactement {}"
    ),
    at_start="{} (au début)",
    there_at_start="au début : {}",
    stretches={
        "initially": "au début du déroulement",
        "at start": "au début de la partie que la règle protège",
        "throughout": "pendant toute la partie que la règle protège",
        "at some point": "à un moment de la partie que la règle protège",
        "at end": "à la fin de la partie que la règle protège",
    },
    exempt="cela ne compte pas si, {} :",
    counts_only="cela ne compte que si, {} :",
    counts_never="cela ne compte jamais, car la condition est fausse avec ces options",
    not_so="ceci n'est pas le cas :",
    adverbs={
        UnaryOperator.ALWAYS: "à [tout moment {}|tout moment|partir de là, toujours] :",
        UnaryOperator.NEVER: "[à aucun moment {},|jamais|à partir de là, jamais] ceci :",
        UnaryOperator.EVENTUALLY: "à [un moment {}|un moment|ce moment ou plus tard] :",
        UnaryOperator.NEXT: "[{}|à l'instant suivant] :",
        UnaryOperator.WEAK_NEXT: "[{}, si le déroulement dure jusque-là|à l'instant suivant, s'il "
        "y en a un] :",
        UnaryOperator.ONCE: "[à un moment {}|au début ou avant|à ce moment ou avant] :",
        UnaryOperator.HISTORICALLY: "[à tout moment {}|jusqu'au début, toujours|jusqu'à ce "
        "moment, toujours] :",
        UnaryOperator.PREVIOUSLY: "[{}|à l'instant précédent] :",
        UnaryOperator.WEAK_PREVIOUSLY: "[{}, si le déroulement avait commencé|à l'instant "
        "précédent, s'il y en avait un] :",
    },
    binary={
        BinaryOperator.UNTIL: "ceci : {left}, jusqu'à ce que, [tôt ou tard|à un moment {span}], "
        "ceci : {right}",
        BinaryOperator.WEAK_UNTIL: "ceci : {left}, et cela [pour toujours|à tout moment "
        "{first}|pour toujours], ou seulement jusqu'à ce que, à un moment[| {span}], ceci : "
        "{right}",
        BinaryOperator.RELEASE: "sauf libération préalable par un instant avec ceci : {left}, à "
        "tout moment[| {span}] : {right}",
        BinaryOperator.STRONG_RELEASE: "sauf libération préalable par un instant, qui doit "
        "venir[,| {first},|,] avec ceci : {left}, à tout moment[| {span}] : {right}",
        BinaryOperator.SINCE: "ceci : {left}, et cela depuis [que|un instant {span} où] ceci : "
        "{right}",
    },
    iff="ceci : {}, si et seulement si ceci : {}",
    xor="ou bien ceci : {}, ou bien ceci : {}, mais pas les deux",
    implies="si ceci : {}, alors ceci : {}",
    means="{} si et seulement si ceci est le cas : {}",
    where="{}, où :",
    either="au moins l'un de ceux-ci : {}",
    both="les deux à la fois : {}",
    all_="tout cela : {}",
    both_of="ces deux choses sont vraies :",
    all_of="toutes ces choses sont vraies :",
    one_of="au moins une de ces choses est vraie :",
    none_of="aucune de ces choses n'est vraie :",
    phase_line="sans interruption d'abord{}",
    phase=" : {}",
    phase_joint=", puis",
    lasting_phase=" {} : {}",
    lasting_item="{} : {}",
    phases="ces phases se suivent sans interruption, chacune pendant au moins un instant :",
)
