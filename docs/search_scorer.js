"use strict";
// Scores of the site's search, Sphinx's own but for the order of parts: who looks for a word wants the guide about it
// first and the modules whose titles have it last.  The commands are no modules.
var Scorer = {
  score: ([page, title, anchor, description, score]) =>
    score + (page.startsWith("guides/") ? 1000 : page.startsWith("api/") && page !== "api/commands" ? -1000 : 0),
  objNameMatch: 11,
  objPartialMatch: 6,
  objPrio: {0: 15, 1: 5, 2: -5},
  objPrioDefault: 0,
  title: 15,
  partialTitle: 7,
  term: 5,
  partialTerm: 2,
};
