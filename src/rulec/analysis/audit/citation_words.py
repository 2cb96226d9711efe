"""The words and signs of which citations are made in the languages of Europe, as patterns.

Words are understood in any case; letters that are words only with a full stop have one here.
"""

from __future__ import annotations

from typing import Final

ARTICLE: Final = (
    r"§§?|(?i:art(?:\b\.?|(?:ic(?:le|olo|ul[oe])|icles|icoli|ículos?|ikel[ns]?|ikler|ikk?el(?:en)?"
    r"|ykuły?|ikkelen)\b)|arts\b\.?|článk\w*|článek|čl\b\.?|artigos?\b|artículo\b"
    r"|pykälä\b|paragraf(?:en)?\b|paragraaf\b|rules?\b|regels?\b|reg(?:ulation)?s?\b\.?"
    r"|ss\.|s\.|sec(?:tion|ción|t)?s?\b\.?)|[Rr]\b|rr?\."
)
"""An article, section, rule or regulation, before its number."""
ANNEX: Final = (
    r"(?i:annexe?|anlage|anhang|appendix|schedule|bijlage|bilag|bilaga|vedlegg|allegato|anexo"
    r"|załącznik|příloha)\b"
)
SIGN: Final = (
    r"(?i:(?:verkehrs|trafik|trafikk|veg|vei)?zeichen|signs?|(?:trafikk?|vei)?skilt"
    r"|(?:väg)?märket?|(?:verkeers)?bord|panneau|signal|segnale|señal|znak|značka)\b|Z\b"
)
PARAGRAPH: Final = (
    r"(?i:abs\.?|absatz|absätze|al\.?|alinéas?|paras?\.?|paragraphs?|par\.?|stk\.?|stykke|ledd"
    r"|st\b\.?|stycket?|lid|leden|ust\.?|ustęp|odst\.?|odstavec|odstavce|mom\.?|momentti|apdo\.?"
    r"|apartado|ap\.|párrafo)"
)
SENTENCE: Final = (
    r"(?:ss?\.|S\.|(?i:sentences?|satz|sätze|meningen|punktum|volzin|phrase|periodo|zdanie|věta))"
)
NUMBER: Final = (
    r"(?i:nos?\b\.?|n\.\s?(?:[º°]|os\b)|n[º°]|nrn?\b\.?|numm?ern?\b|num\b\.?|núm\b\.?|número|numéro|numero"
    r"|items?\b|points?\b|punto\b|punten\b|punkte?r?\b|punkten\b|punt\b|p\.|pkt\b\.?|pts?\.|bod\b"
    r"|ziff(?:er)?\b\.?|c\.|commas?\b|onderdeel\b|z\b\.?)"
)
LETTER: Final = (
    r"(?i:lit\b\.?|litt?er?as?\b|litra\b|letters?\b|lett\b\.?|lettera\b|letra\b|lettre\b|alíneas?\b"
    r"|buchst\b\.?|buchstaben?\b|bokstav(?:en)?\b|bogstav\b|písm\b\.?|písmeno\b|onder\b|sub\b)"
)
COUNTED: Final = {
    "1": r"første|første|första|eerste|first|erster|premier|primo",
    "2": r"annet|anden|andet|andra|tweede|second|zweiter|deuxième|secondo",
    "3": r"tredje|derde|third|dritter|troisième|terzo",
    "4": r"fjerde|fjärde|vierde|fourth|vierter|quatrième|quarto",
    "5": r"femte|vijfde|fifth|fünfter|cinquième|quinto",
}
"""The words for the first paragraphs and sentences: `første ledd`, `eerste lid`."""
CHAPTER: Final = r"(?i:kap(?:itel|itlet)?\b\.?|ch(?:apter)?\b\.?)"
AND: Final = r"(?i:and|or|und|oder|et|ou|og|och|eller|en|sowie|oraz|lub|nebo|sekä|ja)"
AND_IN_A_LETTER: Final = r"[aeiyou]"
"""Polish and Italian: only between numbers or marks, since they may be letters."""
