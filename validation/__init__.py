"""Published cases (`published`), verification of the methods (`verification`), and the ledger of claims (`claims`)."""
