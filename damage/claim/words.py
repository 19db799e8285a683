"""The words of the sheet in English and Dutch: the same keys in both, which a test compares.

Dutch terms are those of the Instituut Mijnbouwschade Groningen, NPR 9998 and SBR-A as public texts have them:
trillingssnelheid, ongelijkmatige zetting, scheurwijdte, lintvoeg.
"""

LANGUAGES = "en", "nl"

_EN = {
    "title": "Cracks in a front: with and without the earthquakes",
    "sheet_of": "Sheet of {date}, {house}, {latitude} N {longitude} E",
    "answer": "Answer", "no_answer": "No answer",
    "no_answer_why": "The evidence for an answer is missing:",
    "why_draws": "only {value} of the computed walls resemble the survey (effective number; expected {limit} or more)",
    "why_strange": "the surveyed cracks are stranger than {value} % of the computed ones (limit {limit} %): the model of "
                   "the front may be another wall than this one",
    "why_off_joints": "{value} % of the drawn crack length lies on no joint of the modelled wall (limit {limit} %)",
    "why_small": "the widest surveyed crack is {value} mm: below {limit} mm cracks do not tell their cause",
    "not_without_earthquakes_yes": "Without the earthquakes the modelled front would have no visible cracks.",
    "not_without_earthquakes_no": "Without the earthquakes the modelled front would have visible cracks, too.",
    "not_without_earthquakes_open": "Whether the front would have visible cracks without the earthquakes cannot be "
                                    "decided: {ranges} of 100 computed walls would have none, by how probable settlement "
                                    "was.",
    "not_without_settlement_yes": "Without settlement the modelled front would have no visible cracks.",
    "not_without_settlement_no": "Without settlement the modelled front would have visible cracks, too.",
    "not_without_settlement_open": "Whether it would have visible cracks without settlement cannot be decided: {ranges} "
                                   "of 100 would have none.",
    "neither_alone_yes": "Neither cause alone would have made them visible.",
    "neither_alone_no": "Each wall with visible cracks would have had them by one cause alone.",
    "neither_alone_open": "In {ranges} of 100 walls neither cause alone makes them visible.",
    "shook": "What shook the house", "when": "date", "place": "place", "magnitude": "M", "km": "km",
    "median": "PGV median [mm/s]", "one_percent": "exceeded with 1 % [mm/s]", "mean_gain": "Psi added (mean)",
    "largest": "The strongest of all events: median {median} mm/s, {one_percent} mm/s is exceeded with 1 %. PGV is the peak "
               "ground velocity by the model {model}.",
    "catalogue_ends": "The list of earthquakes ends on {date}. Later events are not in this sheet.",
    "front": "The front: survey and nearest computed walls", "survey": "survey",
    "survey_is": "{cracks} cracks, {length} m, widest {width} mm; {share} % of the length on joints",
    "nearest": "{cause}, distance {distance}", "cause_both": "settlement and earthquakes",
    "cause_earthquakes": "earthquakes alone",
    "tables": "With and without each cause: walls of 100 with visible cracks (from 0.1 mm), 95 % interval",
    "all_draws": "All {n} computed walls", "like_survey": "Those that resemble the survey",
    "prior": "settlement was {percent} % probable",
    "both": "with all that happened", "earthquakes": "by the earthquakes alone", "settlement": "by settlement alone",
    "none": "by neither", "of_visible": "Of 100 walls that now have visible cracks:",
    "not_without_earthquakes": "not without the earthquakes", "not_without_settlement": "not without the settlement",
    "neither_alone": "by neither cause alone", "effective": "effective number of walls",
    "widths": "Widest crack [mm]: middle (5 to 95 of 100), walls that resemble the survey",
    "before": "without the earthquakes", "added": "added by the earthquakes", "left": "now",
    "what_was_taken": "What was taken",
    "draws": "{n} draws of motions, site and joint strengths, each run with and without the settlement by the same random "
             "numbers; {events} events a draw in the mean from {above} mm/s on. Walls that fell, by earthquakes alone, after "
             "settlement: {fell}; they count as visible in the first table and have no weight in the second. Weight "
             "exp(-(d/{kernel})²/2) by the distance d of the visible cracks (0 alike, 1 no crack at the same place).",
    "settled_given": "Settlement, if there was any: {profile}, distortion 1/{distortion}.",
    "settled_file": "Settlement, if there was any: {profile}.",
    "settled_drawn": "No settlement was measured: it is drawn as hogging, sagging or a knick, 1/{least} to 1/{most}.",
    "widths_used": "The widths of the survey are compared with the computed ones; the computed walls begin without cracks.",
    "detection": "Cracks are compared from {limit} mm on, widths within {error} mm.",
    "offsets_yes": "The survey says whether the crack faces are offset; this is used.",
    "offsets_no": "The survey does not say whether the crack faces are offset, which tells settlement from shaking best.",
    "evidence": "Evidence for this wall", "inside": "Inside the range of validity in all {known} quantities.",
    "outside": "Outside the model's range of validity in {found} of {known} quantities: {names}.",
    "not_in": "What is not in the model",
    "not_in_text": "Other causes (shrinkage, temperature, moisture, corroding lintels, works nearby), movement out of the "
                   "wall's plane, foundations, other walls of the house, and settlement caused by the shaking. No test "
                   "has shown that masonry keeps the offsets that the model leaves after repeated shaking.",
    "no_expert": "This sheet gives what a model computes. It is no expert's opinion and no probability of cause.",
    "made_by": "{software}; every number: {json}",
}
_NL = {
    "title": "Scheuren in een gevel: met en zonder de aardbevingen",
    "sheet_of": "Blad van {date}, {house}, {latitude} N {longitude} O",
    "answer": "Antwoord", "no_answer": "Geen antwoord",
    "no_answer_why": "Voor een antwoord ontbreekt het bewijs:",
    "why_draws": "slechts {value} van de berekende muren lijken op de opname (effectief aantal; verwacht {limit} of meer)",
    "why_strange": "de opgenomen scheuren zijn vreemder dan {value} % van de berekende (grens {limit} %): de gemodelleerde "
                   "gevel kan een andere zijn dan deze",
    "why_off_joints": "{value} % van de getekende scheurlengte ligt op geen voeg van de gemodelleerde muur (grens {limit} %)",
    "why_small": "de wijdste opgenomen scheur is {value} mm: onder {limit} mm verraden scheuren hun oorzaak niet",
    "not_without_earthquakes_yes": "Zonder de aardbevingen zou de gemodelleerde gevel geen zichtbare scheuren hebben.",
    "not_without_earthquakes_no": "Ook zonder de aardbevingen zou de gemodelleerde gevel zichtbare scheuren hebben.",
    "not_without_earthquakes_open": "Of de gevel zonder de aardbevingen zichtbare scheuren zou hebben, is niet te "
                                    "beslissen: {ranges} van 100 berekende muren zouden er geen hebben, naar gelang de kans "
                                    "op zetting.",
    "not_without_settlement_yes": "Zonder zetting zou de gemodelleerde gevel geen zichtbare scheuren hebben.",
    "not_without_settlement_no": "Ook zonder zetting zou de gemodelleerde gevel zichtbare scheuren hebben.",
    "not_without_settlement_open": "Of zij er zonder zetting zouden zijn, is niet te beslissen: {ranges} van 100 muren "
                                   "zouden er geen hebben.",
    "neither_alone_yes": "Geen van beide oorzaken alleen zou ze zichtbaar hebben gemaakt.",
    "neither_alone_no": "Elke muur met zichtbare scheuren zou die ook door één oorzaak alleen hebben.",
    "neither_alone_open": "In {ranges} van 100 muren maakt geen van beide oorzaken alleen ze zichtbaar.",
    "shook": "Wat het huis heeft geschud", "when": "datum", "place": "plaats", "magnitude": "M", "km": "km",
    "median": "trillingssnelheid (PGV), mediaan [mm/s]", "one_percent": "overschreden met 1 % [mm/s]",
    "mean_gain": "toename Psi (gemiddeld)",
    "largest": "De sterkste van alle bevingen: mediaan {median} mm/s, {one_percent} mm/s wordt met 1 % kans overschreden. "
               "PGV is de hoogste trillingssnelheid van de grond volgens het model {model}.",
    "catalogue_ends": "De lijst van aardbevingen eindigt op {date}. Latere bevingen staan niet op dit blad.",
    "front": "De gevel: opname en de meest gelijkende berekende muren", "survey": "opname",
    "survey_is": "{cracks} scheuren, {length} m, wijdste {width} mm; {share} % van de lengte op voegen",
    "nearest": "{cause}, afstand {distance}", "cause_both": "zetting en aardbevingen",
    "cause_earthquakes": "alleen aardbevingen",
    "tables": "Met en zonder elke oorzaak: muren van 100 met zichtbare scheuren (vanaf 0,1 mm), 95 %-interval",
    "all_draws": "Alle {n} berekende muren", "like_survey": "Die op de opname lijken",
    "prior": "kans op zetting was {percent} %",
    "both": "met alles wat gebeurde", "earthquakes": "door de aardbevingen alleen", "settlement": "door zetting alleen",
    "none": "door geen van beide", "of_visible": "Van 100 muren die nu zichtbare scheuren hebben:",
    "not_without_earthquakes": "niet zonder de aardbevingen", "not_without_settlement": "niet zonder de zetting",
    "neither_alone": "door geen oorzaak alleen", "effective": "effectief aantal muren",
    "widths": "Wijdste scheur [mm]: midden (5 tot 95 van 100), muren die op de opname lijken",
    "before": "zonder de aardbevingen", "added": "erbij door de aardbevingen", "left": "nu",
    "what_was_taken": "Waarvan is uitgegaan",
    "draws": "{n} trekkingen van bewegingen, plaats en sterkte van de voegen, elk met en zonder de zetting berekend met "
             "dezelfde toevalsgetallen; gemiddeld {events} bevingen per trekking vanaf {above} mm/s. Muren die instortten, "
             "door aardbevingen alleen, na zetting: {fell}; zij tellen als zichtbaar in de eerste tabel en niet in de "
             "tweede. Gewicht exp(-(d/{kernel})²/2) naar de afstand d van de zichtbare scheuren (0 gelijk, 1 geen scheur op "
             "dezelfde plaats).",
    "settled_given": "De zetting, als die er was: {profile}, hoekverdraaiing 1/{distortion}.",
    "settled_file": "De zetting, als die er was: {profile}.",
    "settled_drawn": "Er is geen zetting gemeten: getrokken als bolle (hogging) of holle (sagging) zetting of knik, "
                     "1/{least} tot 1/{most}.",
    "widths_used": "De scheurwijdten van de opname worden met de berekende vergeleken; de berekende muren beginnen zonder "
                   "scheuren.",
    "detection": "Scheuren worden vanaf {limit} mm vergeleken, scheurwijdten binnen {error} mm.",
    "offsets_yes": "De opname zegt of de scheurvlakken verschoven zijn; dat is gebruikt.",
    "offsets_no": "De opname zegt niet of de scheurvlakken verschoven zijn, wat zetting het best van trilling onderscheidt.",
    "evidence": "Bewijs voor deze muur", "inside": "Binnen het geldigheidsgebied in alle {known} grootheden.",
    "outside": "Buiten het geldigheidsgebied van het model in {found} van {known} grootheden: {names}.",
    "not_in": "Wat niet in het model zit",
    "not_in_text": "Andere oorzaken (krimp, temperatuur, vocht, roestende lateien, werken in de buurt), beweging uit het vlak "
                   "van de muur, funderingen, andere muren van het huis, en zetting door de trillingen zelf. Geen proef heeft "
                   "laten zien dat metselwerk de verschuivingen houdt die het model na herhaald schudden overlaat.",
    "no_expert": "Dit blad geeft wat een model berekent. Het is geen oordeel van een deskundige en geen kans op een oorzaak.",
    "made_by": "{software}; elk getal: {json}",
}
WORDS = {"en": _EN, "nl": _NL}

PROFILES = {"hogging": "bolle zetting (hogging)", "sagging": "holle zetting (sagging)", "tilt": "scheefstand",
            "knick": "knik"}
"""Dutch of `damage.motion.settlement.PROFILES`."""
QUANTITIES = {
    "vertical components of the motion": "verticale beweging", "drift": "scheefstand (drift)", "slip of a joint":
    "verschuiving van een voeg", "slip over the overlap of the faces": "verschuiving over het raakvlak",
    "bricks followed after a fall": "stenen gevolgd na een val", "precompression of mortar joints":
    "drukspanning op mortelvoegen", "precompression of dry joints": "drukspanning op droge voegen", "length": "lengte",
    "height": "hoogte", "storeys": "bouwlagen", "cohesion of mortar joints": "cohesie van mortelvoegen",
    "tan(phi)": "tan(phi)", "shear failures of brittle joints": "schuifbreuken van brosse voegen",
    "split or crushed length": "gespleten of verbrijzelde lengte", "period of a harmonic motion":
    "periode van een harmonische beweging", "amplitude of a harmonic motion": "amplitude van een harmonische beweging",
    "scale of a record": "factor op een registratie", "rest after the motion": "rust na de beweging",
    "energy balance error": "fout in de energiebalans"}
"""Dutch of the quantities of `damage.measure.evidence` that are judged."""


def number(value, digits, language):
    """A number with so many significant digits, in the language's notation."""
    text = f"{float(f'{value:.{digits}g}'):.10g}"
    return text.replace(".", ",") if language == "nl" else text
