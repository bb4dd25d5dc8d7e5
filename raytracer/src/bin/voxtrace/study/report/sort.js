// Sorts tables by the column whose head is clicked on: numbers by their value, a second time downwards.
// What has no number stands last. Without this the tables are as they are.
for (const table of document.querySelectorAll("table.sortable")) {
  const body = table.tBodies[0];
  const heads = Array.from(table.tHead.rows[table.tHead.rows.length - 1].cells);
  const key = (row, column) => {
    const cell = row.cells[column];
    const number = cell.dataset.value;
    if (number !== undefined) return Number(number);
    return cell.classList.contains("figure") ? undefined : cell.textContent;
  };
  const compare = (a, b) => {
    if (typeof a === "string" || typeof b === "string") {
      return String(a).localeCompare(String(b), "en", { numeric: true });
    }
    return a > b ? 1 : b > a ? -1 : 0;
  };
  heads.forEach((head, column) => {
    const button = document.createElement("button");
    button.append(...head.childNodes);
    head.append(button);
    button.addEventListener("click", () => {
      const falls = head.getAttribute("aria-sort") === "ascending";
      for (const other of heads) other.removeAttribute("aria-sort");
      head.setAttribute("aria-sort", falls ? "descending" : "ascending");
      const rows = Array.from(body.rows).map((row) => [key(row, column), row]);
      rows.sort(([a], [b]) => {
        if (a === undefined || b === undefined) {
          return Number(a === undefined) - Number(b === undefined);
        }
        return falls ? compare(b, a) : compare(a, b);
      });
      body.append(...rows.map(([, row]) => row));
    });
  });
}
