// Guides and the glossary first, headers and diaries last; terms of docs/glossary.md (kind "index") before all.
const weights = [
  [/^docs\/(glossary|limits)$/, 4],
  [/^docs\/theory\//, 4],
  [/^docs\/notes\/|^docs\/decisions$|^docs\/extending$|^CHANGELOG$|^CONTRIBUTING$/, -6],
  [/^docs\//, 8],
  [/^examples\//, 2],
  [/^reference\/cpp\//, -4],
];
var Scorer = {
  score: ([docname, title, anchor, descr, score, filename, kind]) => {
    const weight = weights.find(([pattern]) => pattern.test(docname));
    return score + (weight ? weight[1] : 0);
  },
  objNameMatch: 11,
  objPartialMatch: 6,
  objPrio: { 0: 15, 1: 5, 2: -5 },
  objPrioDefault: 0,
  title: 15,
  partialTitle: 7,
  term: 5,
  partialTerm: 2,
};
