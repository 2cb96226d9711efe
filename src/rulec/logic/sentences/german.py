"""German. Phrases are main clauses, so that they can follow a colon."""

from __future__ import annotations

import re

from rulec.logic.formula import BinaryOperator, UnaryOperator
from rulec.logic.sentences.language import (
    Language,
    SpanWords,
    TypeWords,
)

GERMAN = Language(
    code="de",
    decimal_mark=",",
    quoted="„{}“",
    inner_joints=re.compile(r",| und | oder "),
    no_pause_after=(":", ","),
    runs_on=(),
    and_="und",
    or_="oder",
    then="dann",
    the_name="„{}“",
    the_name_of="„{}“ von {}",
    value=("{} ist „{}“", "{} ist nicht „{}“"),
    value_is="{} beträgt {}",
    atom=("„{}“ gilt", "„{}“ gilt nicht"),
    constants=("alles ist möglich", "Unmögliches gilt"),
    atom_of=("„{}“ gilt für {}", "„{}“ gilt nicht für {}"),
    truth=("„{}“ ist wahr", "„{}“ ist nicht wahr"),
    same=("{} ist dasselbe wie {}", "{} ist nicht dasselbe wie {}"),
    kind=("{} ist {}", "{} ist nicht {}"),
    relations={
        "<": ("{} beträgt weniger als {}", "{} beträgt nicht weniger als {}"),
        "<=": ("{} beträgt höchstens {}", "{} beträgt nicht höchstens {}"),
        "=": ("{} beträgt genau {}", "{} beträgt nicht genau {}"),
        "!=": ("{} ist anders als {}", "{} ist nicht anders als {}"),
        ">=": ("{} beträgt mindestens {}", "{} beträgt nicht mindestens {}"),
        ">": ("{} beträgt mehr als {}", "{} beträgt nicht mehr als {}"),
    },
    times="mal",
    counted={
        "<": "weniger als {}",
        "<=": "höchstens {}",
        "=": "genau {}",
        "!=": "irgendeine Anzahl außer {}",
        ">=": "mindestens {}",
        ">": "mehr als {}",
    },
    there_is="es gibt {} {}, sodass gilt:",
    there_is_no="es gibt {} {}, sodass gilt:",
    there_are="es gibt {} {}, sodass gilt:",
    number_of="die Zahl der {} {} (für die gilt: {})",
    type_words=TypeWords(
        every="jedes Objekt der Art „{}“",
        other="jedes andere Objekt der Art „{}“",
        one="ein Objekt der Art „{}“",
        none="kein Objekt der Art „{}“",
        noun="Objekt der Art „{}“",
        plural="Objekte der Art „{}“",
    ),
    for_every="für {} gilt: ",
    step="Schritt",
    steps="Schritte",
    span=SpanWords("{} oder mehr", "bis zu {}", "{} bis {}", "genau {}"),
    later="später",
    after_start="nach dem Beginn",
    before="vorher",
    lasting=SpanWords("mindestens {} lang", "höchstens {} lang", "{} bis {} lang", "genau {} lang"),
    at_start="{} (am Beginn)",
    there_at_start="am Beginn: {}",
    stretches={
        "initially": "am Beginn des Ablaufs",
        "at start": "am Beginn des Abschnitts, den die Regel schützt,",
        "throughout": "während des ganzen Abschnitts, den die Regel schützt,",
        "at some point": "irgendwann in dem Abschnitt, den die Regel schützt,",
        "at end": "am Ende des Abschnitts, den die Regel schützt,",
    },
    exempt="das zählt nicht, wenn {} gilt:",
    counts_only="das zählt nur, wenn {} gilt:",
    counts_never="das zählt nie, denn so, wie Optionen gesetzt sind, ist die Bedingung falsch",
    not_so="Folgendes gilt nicht:",
    adverbs={
        UnaryOperator.ALWAYS: "[zu jeder Zeit {} gilt|immer gilt|von da an gilt immer]:",
        UnaryOperator.NEVER: "[zu keiner Zeit {} kommt|nie kommt|von da an kommt nie] vor:",
        UnaryOperator.EVENTUALLY: "[irgendwann {}|irgendwann|dann oder später] gilt:",
        UnaryOperator.NEXT: "[{}|im nächsten Augenblick] gilt:",
        UnaryOperator.WEAK_NEXT: "[{}, falls der Ablauf so lange dauert|im nächsten Augenblick, "
        "falls es ihn gibt], gilt:",
        UnaryOperator.ONCE: "[irgendwann {}|am Beginn oder vorher|dann oder vorher] galt:",
        UnaryOperator.HISTORICALLY: "[zu jeder Zeit {} galt|bis zum Beginn galt immer|bis dahin "
        "galt immer]:",
        UnaryOperator.PREVIOUSLY: "[{}|im Augenblick davor] galt:",
        UnaryOperator.WEAK_PREVIOUSLY: "[{}, falls der Ablauf schon begonnen hatte|im Augenblick "
        "davor, falls es ihn gab], galt:",
    },
    binary={
        BinaryOperator.UNTIL: "es gilt: {left}, bis [früher oder später|irgendwann {span}] gilt: "
        "{right}",
        BinaryOperator.WEAK_UNTIL: "es gilt: {left}, und zwar [für immer|zu jeder Zeit "
        "{first}|für immer] oder nur, bis irgendwann[| {span}] gilt: {right}",
        BinaryOperator.RELEASE: "wenn nicht vorher ein Augenblick davon entbindet, in dem gilt: "
        "{left}, so gilt [immer|zu jeder Zeit {span}]: {right}",
        BinaryOperator.STRONG_RELEASE: "wenn nicht vorher ein Augenblick davon entbindet, der "
        "[|{first} |]kommen muss und in dem gilt: {left}, so gilt [immer|zu jeder Zeit {span}]: "
        "{right}",
        BinaryOperator.SINCE: "es gilt: {left}, und zwar [seitdem|seit einem Augenblick {span}, "
        "in dem] galt: {right}",
    },
    iff="genau dann gilt: {}, wenn gilt: {}",
    xor="entweder gilt: {}, oder es gilt: {}, aber nicht beides",
    implies="wenn gilt: {}, dann gilt: {}",
    means="{}, genau wenn dies gilt: {}",
    where="{}, wobei:",
    either="mindestens eines davon: {}",
    both="beides: {}",
    all_="all das: {}",
    both_of="beides gilt:",
    all_of="all das gilt:",
    one_of="mindestens eines davon gilt:",
    none_of="nichts davon gilt:",
    phase_line="lückenlos zuerst{}",
    phase=": {}",
    phase_joint=", dann",
    lasting_phase=" {}: {}",
    lasting_item="{}: {}",
    phases="diese Phasen folgen lückenlos aufeinander, jede mindestens einen Augenblick lang:",
)
