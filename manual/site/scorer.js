// Order of what the search finds. The numbers are Sphinx's own; a scorer has to repeat all of them.
var Scorer = {
  objNameMatch: 11,
  objPartialMatch: 6,
  objPrio: { 0: 15, 1: 5, 2: -5 },
  objPrioDefault: 0,
  title: 15,
  partialTitle: 7,
  term: 5,
  partialTerm: 2,
  // "friction" or "stiffness" are the words of engineers first, and names of classes after that
  score: ([page, , , , score]) => (page === "manual/site/extensions" ? score - 8 : score),
};
